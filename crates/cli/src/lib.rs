//! The command line of Gonio
