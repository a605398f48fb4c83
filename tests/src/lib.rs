//! Whole flights.
