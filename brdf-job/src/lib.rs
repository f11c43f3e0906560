//! Long work that can be watched and stopped.
//!
//! The caller makes a [`Job`] and passes it by reference to a function that takes long. The function reports
//! its progress to the job and asks it now and then whether to stop. The caller can watch the progress, set a
//! deadline, or stop the work by a [`Cancel`] flag. Nothing here prints, and nothing runs in the background.
//!
//! # Example
//!
//! ```
//! use brdf_job::{Job, Stopped};
//!
//! fn sum_of_squares(count: u64, job: &Job<'_>) -> Result<u64, Stopped> {
//!     job.begin("adding", count);
//!     (0..count).try_fold(0, |sum, n| {
//!         job.check()?;
//!         job.advance(1);
//!         Ok(sum + n * n)
//!     })
//! }
//!
//! let show = |progress: &brdf_job::Progress<'_>| assert!(progress.fraction <= 1.0);
//! assert_eq!(sum_of_squares(4, &Job::watched_by(&show)), Ok(14));
//!
//! let cancel = brdf_job::Cancel::new();
//! cancel.cancel();
//! assert!(sum_of_squares(4, &Job::new().with_cancel(&cancel)).is_err());
//! ```

mod job;
mod stop;

pub use job::{Job, Progress};
pub use stop::{Cancel, StopCause, Stopped};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
