//! stub
use crate::run::Task;
pub(crate) fn tasks() -> Vec<Task<'static>> { Vec::new() }
