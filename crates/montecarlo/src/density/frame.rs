//! A right-handed frame of three unit vectors.

use fredholm_mesh::Vec3;

/// Axes x, y and z = x × y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    axes: [Vec3; 3],
}

impl Frame {
    /// A frame whose z is this unit vector.
    #[must_use]
    pub fn about(z: Vec3) -> Self {
        let x = z.any_orthonormal_vector();
        Self { axes: [x, z.cross(x), z] }
    }

    /// The vector with these components.
    #[must_use]
    pub fn world(&self, local: Vec3) -> Vec3 {
        self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    /// The components of a vector.
    #[must_use]
    pub fn local(&self, world: Vec3) -> Vec3 {
        Vec3::new(self.axes[0].dot(world), self.axes[1].dot(world), self.axes[2].dot(world))
    }
}
