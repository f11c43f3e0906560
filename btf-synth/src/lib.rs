//! A virtual gonioreflectometer.
