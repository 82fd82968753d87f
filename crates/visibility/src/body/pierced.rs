//! Whether a segment passes through a convex body: what of it lies below each face, face by face.
//!
//! M. Cyrus & J. Beck, Comput. Graph. 3(1) 23, 1978, doi:10.1016/0097-8493(78)90021-3. Lengths in metres.

use fredholm_mesh::Vec3;

use super::Body;

impl Body {
    /// Whether a part of the segment lies deeper than `depth` (m) below the planes of all faces; a negative depth is a height. Of a flat body, at a height, that only tells whether the segment
    /// comes to its plane.
    #[must_use]
    pub fn is_pierced(&self, [a, b]: [Vec3; 2], depth: f64) -> bool {
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for face in &self.faces {
            let (from, to) = (face.height(a) + depth, face.height(b) + depth);
            if from >= 0.0 && to >= 0.0 {
                return false;
            }
            if from > 0.0 {
                first = first.max(from / (from - to));
            } else if to > 0.0 {
                last = last.min(from / (from - to));
            }
        }
        first < last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;

    /// The square of side 2 about the origin, below z = 0.
    fn square() -> Body {
        let corners = [[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]].map(|[x, y]| Vec3::new(x, y, 0.0));
        Body::flat(corners.to_vec(), Vec3::Z, &Frame::around(&[]).unwrap())
    }

    #[test]
    fn a_flat_body_has_no_inside() {
        let across = [Vec3::Z, Vec3::NEG_Z];
        assert!(!square().is_pierced(across, 0.0) && square().is_pierced(across, -1e-9));
        assert!(!square().is_pierced([Vec3::Z, Vec3::X + Vec3::Z], -1e-9));
    }
}
