#pragma once

namespace metier {

/// A pose in the form of OPC UA's 3DFrame: position x, y, z [m] and rotations a, b, c about x, y, z
/// [rad] with R = Rz(c) * Ry(b) * Rx(a). The name of a variable states the frames: base_from_tool.
/// Conversion to a quaternion: motion::toPose().
struct Frame {
    /// Position [m].
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    /// Rotations about x, y and z [rad]; any finite value.
    double a = 0.0;
    double b = 0.0;
    double c = 0.0;

    friend bool operator==(const Frame&, const Frame&) = default;
};

/// Three numbers along x, y, z; their unit and frame are stated where the vector is used.
struct Vector3 {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend bool operator==(const Vector3&, const Vector3&) = default;
};

/// An interval with both ends included, in the unit of its use. The skill model reads 0..0 as "not
/// set".
struct Range {
    double low = 0.0;
    double high = 0.0;

    friend bool operator==(const Range&, const Range&) = default;
};

}  // namespace metier
