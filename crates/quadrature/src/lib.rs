//! Integration rules on the interval, the triangle and the quadrilateral.
