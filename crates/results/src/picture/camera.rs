//! From metres to pixels.

use tdem_engine::physics::{Vec3, vec3};

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    eye: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    forward: Vec3<f64>,
    /// Pixels per unit of tangent.
    focus: f64,
    centre: [f64; 2],
    nearest: f64,
}

/// Where a point is in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    /// Pixels from the left.
    pub(super) x: f64,
    /// Pixels from the top.
    pub(super) y: f64,
    /// Distance along the line of sight, m.
    pub(super) depth: f64,
}

impl Camera {
    /// A camera in some direction from a box, as near as the picture can hold the box.
    pub(super) fn looking_at(
        low: [f64; 3],
        high: [f64; 3],
        direction: [f64; 3],
        angle_deg: f64,
        [columns, rows]: [usize; 2],
    ) -> Self {
        let (low, high) = (Vec3::from(low), Vec3::from(high));
        let towards_eye = unit(direction.into()).unwrap_or(vec3(0.0, -1.0, 0.0));
        let forward = -towards_eye;
        // Straight from above or below, y points up in the picture.
        let right = unit(forward.cross(vec3(0.0, 0.0, 1.0))).unwrap_or(vec3(1.0, 0.0, 0.0));
        let up = right.cross(forward);

        let tangent = (0.5 * angle_deg.clamp(1.0, 120.0)).to_radians().tan();
        let (width, height) = (columns as f64, rows as f64);
        let focus = 0.5 * height / tangent;
        let middle = (low + high) * 0.5;
        // Each corner must be inside the pyramid of view: that asks for a distance, and the largest is kept.
        let distance = (0..8)
            .map(|corner| {
                let pick = |bit: usize, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
                let offset = vec3(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z)) - middle;
                let across = offset.dot(right).abs() * focus / (0.5 * width);
                let along = offset.dot(up).abs() * focus / (0.5 * height);
                across.max(along) * MARGIN - offset.dot(forward)
            })
            .fold(f64::MIN_POSITIVE, f64::max);
        Camera {
            eye: middle - forward * distance,
            right,
            up,
            forward,
            focus,
            centre: [0.5 * width, 0.5 * height],
            nearest: 1e-3 * distance,
        }
    }

    /// Where a point is in the picture; nowhere if it is behind the camera.
    pub(super) fn project(&self, point: [f64; 3]) -> Option<Image> {
        let offset = Vec3::from(point) - self.eye;
        let depth = offset.dot(self.forward);
        (depth > self.nearest).then(|| Image {
            x: self.centre[0] + self.size_at(depth, offset.dot(self.right)),
            y: self.centre[1] - self.size_at(depth, offset.dot(self.up)),
            depth,
        })
    }

    /// Pixels that a length takes at a depth.
    pub(super) fn size_at(&self, depth: f64, length: f64) -> f64 {
        self.focus * length / depth
    }
}

/// Space left around the subject.
const MARGIN: f64 = 1.06;

fn unit(vector: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = vector.dot(vector).sqrt();
    (length > 1e-9).then(|| vector * (1.0 / length))
}
