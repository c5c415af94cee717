//! Picture files: reading untrusted ones within limits, writing PNG.
