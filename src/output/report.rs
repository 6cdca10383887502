//! A report of a study as files.

use std::path::{Path, PathBuf};

use super::csv;
use crate::error::Error;
use crate::files::replace;
#[cfg(feature = "plot")]
use crate::plot::{convergence, work_precision};
use crate::study::Report;

impl Report {
    /// The rows as comma-separated values: see [`to_csv`](super::to_csv).
    pub fn to_csv(&self) -> String {
        csv::to_csv(&self.rows)
    }

    /// Writes `report.json`, `report.csv` and the plots `convergence` and `work_precision`, each as
    /// `.svg` and `.png`, into a directory, which is made if need be. Returns the files in order.
    /// Without the feature `plot` there are no plots. Each file is replaced as a whole: a reader never
    /// sees a part of it.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let directory = directory.as_ref();
        let mut written = Vec::new();
        let mut put = |name: &str, file: &dyn Fn(&Path) -> Result<(), String>| {
            written.push(replace(&directory.join(name), file)?);
            Ok::<(), Error>(())
        };
        let text =
            |path: &Path, text: String| std::fs::write(path, text).map_err(|e| e.to_string());
        put("report.json", &|path| text(path, self.to_json()))?;
        put("report.csv", &|path| text(path, self.to_csv()))?;
        #[cfg(feature = "plot")]
        for (name, figure) in [
            ("convergence", convergence(&self.rows)),
            ("work_precision", work_precision(&self.rows)),
        ] {
            put(&format!("{name}.svg"), &|path| text(path, figure.to_svg()?))?;
            put(&format!("{name}.png"), &|path| figure.write_png(path))?;
        }
        Ok(written)
    }
}
