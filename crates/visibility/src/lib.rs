//! Segment and ray queries against the surfaces of a scene.
