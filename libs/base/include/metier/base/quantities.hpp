#pragma once

namespace metier {

/// A pose in the form of OPC UA's 3DFrame: position x, y, z [m] and rotations a, b, c about x, y, z
/// [rad] with R = Rz(c) * Ry(b) * Rx(a). The name of a variable states the frames: base_from_tool.
/// Conversion to a quaternion: motion::toPose().
///
/// Threading: a value. Source: OPC 10000-5 (3DFrame).
struct Frame {
    /// Along x [m].
    double x = 0.0;
    /// Along y [m].
    double y = 0.0;
    /// Along z [m].
    double z = 0.0;
    /// About x [rad], any finite value as the other two; applied first.
    double a = 0.0;
    /// About y [rad]; at +-pi/2 the angles a and c turn about the same axis (gimbal lock).
    double b = 0.0;
    /// About z [rad]; applied last.
    double c = 0.0;

    /// Compares the six numbers exactly: two triples of angles for the same rotation are not equal.
    friend bool operator==(const Frame&, const Frame&) = default;
};

/// Three numbers along x, y, z; their unit and frame are stated where the vector is used.
struct Vector3 {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    /// Compares exactly, without a tolerance.
    friend bool operator==(const Vector3&, const Vector3&) = default;
};

/// An interval with both ends included, in the unit of its use. The skill model reads 0..0 as "not
/// set".
/// Source: OPC 10000-8 (Range), as in the EURange of an analog item.
struct Range {
    /// Smallest value that belongs to it.
    double low = 0.0;
    /// Largest value that belongs to it; nothing here checks that it is not below `low`.
    double high = 0.0;

    friend bool operator==(const Range&, const Range&) = default;
};

}  // namespace metier
