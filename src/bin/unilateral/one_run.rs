//! One directory has one run at a time.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::shared::{Request, cannot_write, warn};

/// The empty file of a directory that its run locks. It stays; what keeps others out is the lock.
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
    let file = File::options().append(true).create(true).open(&name);
    let file = file.map_err(|e| cannot_write(&name, e))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(format!(
                "{}: another process writes its report there; wait for its end, or choose another directory",
                path.display()
            ));
        }
        // some file systems have no locks
        Err(TryLockError::Error(why)) => {
            let path = path.display();
            warn(&format!("warning: {path} cannot be locked, start no other run there: {why}"));
        }
    }
    taken.push((own, file));
    Ok(())
}
