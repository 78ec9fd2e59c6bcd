#pragma once

#include <cstdint>
#include <optional>

namespace metier::virtual_wsg50 {

/// Obstacles in the way of the jaws.
struct Obstacles {
    std::optional<double> part{};   ///< width of a part between the jaws [m]
    std::optional<double> block{};  ///< a width the jaws cannot pass, from either side [m]
};

/// The opening of the jaws: moves with limited speed and acceleration, and stops at obstacles.
///
/// Threading: one thread.
class Jaws {
public:
    enum class Contact : std::uint8_t { none, closing, opening };

    /// \param stroke the opening is between 0 and this [m]
    /// \param width  at the beginning [m]
    Jaws(double stroke, double width) noexcept : stroke_(stroke), width_(width), target_(width) {}

    /// \param target [m]
    /// \param speed  [m/s], > 0
    void moveTo(double target, double speed) noexcept;
    /// Brakes as hard as the acceleration allows.
    void brake() noexcept;
    /// Stands at once.
    void halt() noexcept;
    void step(double seconds, const Obstacles& obstacles) noexcept;

    double acceleration = 2.0;  ///< [m/s2], > 0

    double width() const noexcept { return width_; }        ///< [m]
    double velocity() const noexcept { return velocity_; }  ///< [m/s], opening > 0
    double target() const noexcept { return target_; }      ///< [m]
    bool arrived() const noexcept { return width_ == target_ && velocity_ == 0.0; }
    /// Obstacle against which the jaws press, with the direction.
    Contact contact() const noexcept { return contact_; }

private:
    void advance(double seconds) noexcept;
    void stopAt(const Obstacles& obstacles, double before) noexcept;

    double stroke_;
    double width_;
    double velocity_ = 0.0;
    double target_;
    double speed_ = 0.1;
    Contact contact_ = Contact::none;
};

}  // namespace metier::virtual_wsg50
