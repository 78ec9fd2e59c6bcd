#include "speed_map.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

SpeedMap SpeedMap::constant(double speed) {
    SpeedMap map;
    map.speed_ = speed;
    map.end_ = 1 / speed;
    return map;
}

SpeedMap SpeedMap::varying(const std::vector<double>& places, const std::vector<double>& speed,
                           const std::vector<double>& slope) {
    SpeedMap map;
    for (std::size_t k = 0; k < speed.size(); ++k) {
        if (k > 0) {
            const double before = speed[k - 1] * speed[k - 1];
            const double rise = speed[k] * speed[k] - before;
            const double step = places[k] - places[k - 1];
            const double m0 = 2 * slope[k - 1] * step;
            const double m1 = 2 * slope[k] * step;
            // Simpson's rule on 1/speed; its square is the cubic with the slopes at both ends.
            constexpr int parts = 16;
            double sum = 1 / speed[k - 1] + 1 / speed[k];
            for (int part = 1; part < parts; ++part) {
                const double u = static_cast<double>(part) / parts;
                const double z =
                    before + u * (m0 + u * (3 * rise - 2 * m0 - m1 + u * (m0 + m1 - 2 * rise)));
                sum += (part % 2 == 1 ? 4 : 2) / std::sqrt(z);
            }
            map.end_ += step / (3 * parts) * sum;
        }
        map.nodes_.push_back({map.end_, {places[k], speed[k], slope[k]}});
    }
    return map;
}

SpeedMap::Quintic SpeedMap::around(double clock) const noexcept {
    const auto after =
        std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, clock,
                         [](double value, const Node& node) { return value < node.clock; });
    const Node& b = *after;
    const Node& a = *(after - 1);
    const double h = b.clock - a.clock;
    const double v0 = a.s.velocity * h;
    const double v1 = b.s.velocity * h;
    const double a0 = a.s.acceleration * h * h;
    const double a1 = b.s.acceleration * h * h;
    const double rise = b.s.position - a.s.position;
    return {
        h,
        std::clamp((clock - a.clock) / h, 0.0, 1.0),
        {a.s.position, v0, a0 / 2, 10 * rise - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
         -15 * rise + 8 * v0 + 7 * v1 + 1.5 * a0 - a1, 6 * rise - 3 * (v0 + v1) - 0.5 * (a0 - a1)}};
}

ScalarState SpeedMap::at(double clock) const noexcept {
    if (nodes_.empty()) {
        return {std::min(clock * speed_, 1.0), speed_, 0.0};
    }
    const auto [h, u, c] = around(clock);
    return {c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5])))),
            (c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * 5 * c[5])))) / h,
            (2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * 20 * c[5]))) / (h * h)};
}

double SpeedMap::jerkAt(double clock) const noexcept {
    if (nodes_.empty()) {
        return 0;
    }
    const auto [h, u, c] = around(clock);
    return (6 * c[3] + u * (24 * c[4] + u * 60 * c[5])) / (h * h * h);
}

double SpeedMap::clockAt(double s) const noexcept {
    if (nodes_.empty()) {
        return s * end_;
    }
    const auto after =
        std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, s,
                         [](double value, const Node& node) { return value < node.s.position; });
    double low = (after - 1)->clock;
    double high = after->clock;
    if (s <= (after - 1)->s.position) {
        return low;
    }
    constexpr int halvings = 60;  // to the last bit
    for (int i = 0; i < halvings && low < high; ++i) {
        const double middle = low + (high - low) / 2;
        (at(middle).position < s ? low : high) = middle;
    }
    return high;
}

}  // namespace metier::motion
