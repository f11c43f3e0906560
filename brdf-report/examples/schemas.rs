//! Writes the JSON Schema of every record into a folder: `cargo run -p brdf-report --features schema --example schemas
//! docs/schema`.

use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder: PathBuf = std::env::args_os().nth(1).ok_or("expected a folder")?.into();
    std::fs::create_dir_all(&folder)?;
    for (name, schema) in brdf_report::schemas() {
        let text = serde_json::to_string_pretty(&schema)? + "\n";
        std::fs::write(folder.join(format!("{name}.json")), text)?;
    }
    Ok(())
}
