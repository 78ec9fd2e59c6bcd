#include "jaws.hpp"

#include <algorithm>
#include <cmath>

namespace metier::virtual_wsg50 {

namespace {

constexpr double kTouch = 1e-9;  // [m]

}  // namespace

void Jaws::moveTo(double target, double speed) noexcept {
    target_ = target;
    speed_ = speed;
    contact_ = Contact::none;
}

void Jaws::brake() noexcept {
    const double way = velocity_ * velocity_ / (2.0 * acceleration);
    target_ = std::clamp(width_ + std::copysign(way, velocity_), 0.0, stroke_);
}

void Jaws::halt() noexcept {
    target_ = width_;
    velocity_ = 0.0;
}

void Jaws::step(double seconds, const Obstacles& obstacles) noexcept {
    const double before = width_;
    advance(seconds);
    stopAt(obstacles, before);
}

void Jaws::advance(double seconds) noexcept {
    const double remaining = target_ - width_;
    const double distance = std::abs(remaining);
    const double most = acceleration * seconds;
    const double wanted =
        std::copysign(std::min(speed_, std::sqrt(2.0 * acceleration * distance)), remaining);
    velocity_ += std::clamp(wanted - velocity_, -most, most);
    const double way = velocity_ * seconds;
    if (distance <= std::max(std::abs(way), most * seconds) && way * remaining >= 0.0) {
        width_ = target_;
        velocity_ = 0.0;
        return;
    }
    width_ = std::clamp(width_ + way, 0.0, stroke_);
}

void Jaws::stopAt(const Obstacles& obstacles, double before) noexcept {
    contact_ = Contact::none;
    const auto stop = [this](double width, Contact contact) {
        width_ = width;
        velocity_ = 0.0;
        contact_ = contact;
    };
    for (const auto& obstacle : {obstacles.part, obstacles.block}) {
        if (obstacle && target_ < *obstacle - kTouch && before >= *obstacle - kTouch &&
            width_ <= *obstacle) {
            stop(*obstacle, Contact::closing);
        }
    }
    const auto& block = obstacles.block;
    if (block && target_ > *block + kTouch && before <= *block + kTouch && width_ >= *block) {
        stop(*block, Contact::opening);
    }
}

}  // namespace metier::virtual_wsg50
