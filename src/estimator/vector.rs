//! Three components on (nose, left, up), and rotations of them.

/// A vector.
pub type Vector = [f64; 3];

/// The cross product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + s·b`.
pub fn add_scaled(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// The length.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The same direction with length 1; `None` where there is none.
pub fn unit(a: Vector) -> Option<Vector> {
    let l = length(a);
    (l > 1e-12 && l.is_finite()).then(|| a.map(|c| c / l))
}

/// The matrix that turns vectors by the angle |`turn`| about the axis `turn` (Rodrigues).
pub fn rotation(turn: Vector) -> [Vector; 3] {
    let angle = length(turn);
    // sin(a)/a and (1 − cos a)/a², by their series where a is small.
    let (s, c) = if angle < 1e-4 {
        (1.0 - angle * angle / 6.0, 0.5 - angle * angle / 24.0)
    } else {
        (angle.sin() / angle, (1.0 - angle.cos()) / (angle * angle))
    };
    let [x, y, z] = turn;
    [
        [1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
        [c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x],
        [c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)],
    ]
}

/// A matrix, by its rows, times a vector.
pub fn product(matrix: &[Vector; 3], vector: Vector) -> Vector {
    matrix.map(|row| dot(row, vector))
}
