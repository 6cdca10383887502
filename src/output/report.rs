//! A report of a study as files.

use std::path::{Path, PathBuf};

use super::csv;
use super::latex::latex_files;
use crate::error::Error;
#[cfg(feature = "plot")]
use crate::error::write_error;
#[cfg(feature = "plot")]
use crate::files::replace;
use crate::files::replace_text;
#[cfg(feature = "plot")]
use crate::plot::{convergence, work_precision};
use crate::study::Report;

impl Report {
    /// The rows as comma-separated values: see [`to_csv`](super::to_csv).
    pub fn to_csv(&self) -> String {
        csv::to_csv(&self.rows)
    }

    /// Writes `report.json`, `report.csv`, `report.md`, `report.tex`, every table of that as
    /// `table-TITLE.tex`, the plots `convergence` and `work_precision`, each as `.svg` and `.png`, and
    /// `report.html` into a directory, which is made if need be. Returns the files in order. The page has
    /// the pictures `SCENE-LABEL.svg` that are in the directory. Without the feature `plot` there are no
    /// plots. Each file is replaced as a whole: a
    /// reader never sees a part of it.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let directory = directory.as_ref();
        let mut written = Vec::new();
        let mut put = |name: &str, text: &str| {
            written.push(replace_text(&directory.join(name), text)?);
            Ok::<(), Error>(())
        };
        put("report.json", &self.to_json())?;
        put("report.csv", &self.to_csv())?;
        put("report.md", &self.to_markdown())?;
        for (name, text) in latex_files("report", &[], &self.latex_tables(), &[]) {
            put(&name, &text)?;
        }
        #[cfg_attr(not(feature = "plot"), expect(unused_mut))]
        let mut page = self.page(directory);
        #[cfg(feature = "plot")]
        for (name, title, figure) in [
            ("convergence", "Error against mesh size", convergence(&self.rows)),
            ("work_precision", "Error against time", work_precision(&self.rows)),
        ] {
            let path = directory.join(name);
            let svg = figure.to_svg().map_err(|why| write_error(&path, why))?;
            written.push(replace_text(&path.with_extension("svg"), &svg)?);
            written.push(replace(&path.with_extension("png"), |path| figure.write_png(path))?);
            page.draw(title, &figure).map_err(|why| write_error(&path, why))?;
        }
        written.push(replace_text(&directory.join("report.html"), &page.to_html())?);
        Ok(written)
    }
}
