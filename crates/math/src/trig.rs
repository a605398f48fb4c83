//! Placeholder.
/// s
pub fn sin_cos(_x: f32) -> (f32, f32) { (0.0, 1.0) }
/// s
pub fn sin(_x: f32) -> f32 { 0.0 }
/// s
pub fn cos(_x: f32) -> f32 { 0.0 }
/// s
pub fn asin(_x: f32) -> f32 { 0.0 }
/// s
pub fn acos(_x: f32) -> f32 { 0.0 }
/// s
pub fn atan2(_y: f32, _x: f32) -> f32 { 0.0 }
