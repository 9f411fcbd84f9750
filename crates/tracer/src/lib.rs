//! The path tracer of Gonio: scene in, image out
