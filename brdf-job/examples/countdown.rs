//! Runs two stages of work that report their progress, until a deadline stops them.
//!
//! ```sh
//! cargo run -p brdf-job --example countdown       # stopped after half a second
//! cargo run -p brdf-job --example countdown 5     # up to five seconds, enough for all of it
//! ```

#![allow(clippy::print_stdout, reason = "an example")]

use std::error::Error;
use std::thread::sleep;
use std::time::{Duration, Instant};

use brdf_job::{Job, Progress, Stopped};

/// Does `steps` pieces of work of 50 ms each.
fn work(stage: &str, steps: u64, job: &Job<'_>) -> Result<(), Stopped> {
    job.begin(stage, steps);
    for _ in 0..steps {
        job.check()?;
        sleep(Duration::from_millis(50));
        job.advance(1);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let seconds: f64 = std::env::args().nth(1).map_or(Ok(0.5), |text| text.parse())?;
    let show = |progress: &Progress<'_>| {
        let Progress { stage, done, total, fraction } = progress;
        println!("{:3.0} %  {stage} {done}/{total}", 100.0 * fraction);
    };
    let deadline = Instant::now() + Duration::try_from_secs_f64(seconds)?;
    let job = Job::watched_by(&show).with_deadline(deadline);
    let [reading, fitting] = job.split([1.0, 3.0]);
    let outcome = work("reading", 5, &reading).and_then(|()| work("fitting", 15, &fitting));
    match outcome {
        Ok(()) => println!("finished"),
        Err(stopped) => println!("{stopped}"),
    }
    Ok(())
}
