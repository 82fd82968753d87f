//! Form factors: kernels, occlusion and the operators assembled from them.
