//! One directory has one run at a time.

use std::fs::{self, File, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use unilateral::input::beginning;
use unilateral::study::Program;

use crate::shared::{Request, cannot_write, warn};

/// The file of a directory that its run locks. It names the process and stays; what keeps others out is the lock.
const LOCK: &str = ".lock";

/// The directories of this process, with the files that it has locked.
static TAKEN: Mutex<Vec<(PathBuf, File)>> = Mutex::new(Vec::new());

/// Makes a directory where there is none, before the work, and refuses one into which another run writes. The system
/// takes the lock back when this process ends, however it does.
pub fn take_directory(path: &Path) -> Request<()> {
    fs::create_dir_all(path).map_err(|e| cannot_write(path, e))?;
    let own = fs::canonicalize(path).map_err(|e| cannot_write(path, e))?;
    let mut taken = TAKEN.lock().unwrap_or_else(PoisonError::into_inner);
    if taken.iter().any(|(other, _)| *other == own) {
        return Ok(());
    }
    let name = path.join(LOCK);
    let mut file = open_own(&name).map_err(|e| cannot_write(&name, e))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(in_use(path, &mut file)),
        // some file systems have no locks
        Err(TryLockError::Error(why)) => {
            let path = path.display();
            warn(&format!("warning: {path} cannot be locked, start no other run there: {why}"));
        }
    }
    let since = Program::new("unilateral", "", 1, 1)
        .date
        .map_or_else(String::new, |date| format!(" since {date}"));
    let holder = format!("process {}{since}", std::process::id());
    let written = file.set_len(0).and_then(|()| file.write_all(holder.as_bytes()));
    written.map_err(|e| cannot_write(&name, e))?;
    taken.push((own, file));
    Ok(())
}

/// Opens the file of the lock, which is made if need be. What leads to another file, by a symbolic link or as another
/// name of it, is not opened: it would be written over.
fn open_own(name: &Path) -> std::io::Result<File> {
    let refuse = || {
        let why = "it is no file of its own: delete it, or choose another directory";
        Err(Error::new(ErrorKind::InvalidInput, why))
    };
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    // a link that takes its place after the check is not followed either
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, nix::libc::O_NOFOLLOW);
    if fs::symlink_metadata(name).is_ok_and(|about| !about.is_file()) {
        return refuse();
    }
    let file = options.open(name)?;
    #[cfg(unix)]
    if std::os::unix::fs::MetadataExt::nlink(&file.metadata()?) > 1 {
        return refuse();
    }
    Ok(file)
}

/// The message for a directory of another run.
fn in_use(path: &Path, file: &mut File) -> String {
    const LONGEST: usize = 200;
    let mut holder = Vec::new();
    // where a locked file is not read by others, the process has no name
    let _ = file.take(LONGEST as u64).read_to_end(&mut holder);
    let holder =
        if holder.is_empty() { "another process".into() } else { beginning(&holder, LONGEST) };
    let path = path.display();
    format!(
        "{path}: {holder} writes its report there; wait for its end, or choose another directory"
    )
}
