#include "fastest_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "metier/base/numbers.hpp"

namespace metier::motion {

namespace {

/// A sum of an unknown and both its neighbours.
struct Stencil {
    double before = 0;
    double at = 0;
    double after = 0;

    Stencil operator+(const Stencil& other) const noexcept {
        return {before + other.before, at + other.at, after + other.after};
    }
    Stencil operator*(double factor) const noexcept {
        return {factor * before, factor * at, factor * after};
    }
    double of(const std::vector<double>& c, std::size_t n) const noexcept {
        return (n > 0 ? before * c[n - 1] : 0) + at * c[n] +
               (n + 1 < c.size() ? after * c[n + 1] : 0);
    }
};

/// The square z of the speed in an interval: a quadratic B-spline, continuous with its slope, that
/// is level at both ends. It has one unknown for each interval.
struct Interval {
    Stencil z;      ///< in the middle
    Stencil slope;  ///< there
    Stencil bend;
    Stencil z_end;  ///< at its end
    Stencil slope_end;
};

Interval intervalAt(const Course& course, std::size_t k) noexcept {
    const auto& s = course.places;
    const double h = s[k + 1] - s[k];
    Stencil z_begin{0, 1, 0};
    Stencil slope_begin{};
    Interval result{{}, {}, {}, {0, 1, 0}, {}};
    if (k > course.first) {
        const double both = s[k + 1] - s[k - 1];
        z_begin = {h / both, 1 - h / both, 0};
        slope_begin = {-2 / both, 2 / both, 0};
    }
    if (k + 1 < course.last) {
        const double both = s[k + 2] - s[k];
        result.z_end = {0, 1 - h / both, h / both};
        result.slope_end = {0, -2 / both, 2 / both};
    }
    result.bend = (result.slope_end + slope_begin * -1) * (1 / h);
    result.slope = (slope_begin + result.slope_end) * 0.5;
    result.z = (z_begin + result.z_end) * 0.5 + result.bend * (-h * h / 8);
    return result;
}

/// sum <= limit, or sum <= limit / sqrt(z) for a jerk.
struct Row {
    std::size_t interval = 0;
    Stencil sum;
    double limit = 0;
    Stencil jerk_z;  ///< z of a jerk, else nothing
    bool jerk = false;
};

double slackOf(const Row& row, const std::vector<double>& c) noexcept {
    const double limit =
        row.jerk ? row.limit / std::sqrt(row.jerk_z.of(c, row.interval)) : row.limit;
    return limit - row.sum.of(c, row.interval);
}

/// All rows of a course; those that cannot bind are left out.
class Rows {
public:
    Rows(const Course& course, double share) : course_(course), share_(share) {
        for (std::size_t k = course.first; k < course.last; ++k) {
            addInterval(k);
        }
    }
    std::vector<Row> take() { return std::move(rows_); }

private:
    void addInterval(std::size_t k) {
        interval_ = k - course_.first;
        const Interval in = intervalAt(course_, k);
        if (k == course_.first) {
            add({0, 1, 0}, course_.ceiling[k]);
        }
        add(in.z_end, course_.ceiling[k + 1]);
        const std::size_t count = course_.bounds[k].count;
        for (std::size_t i = 0; i < count; ++i) {
            bounds_[i] = between(course_.bounds[k].values[i], course_.bounds[k + 1].values[i]);
        }
        const double z = std::max(course_.ceiling[k], course_.ceiling[k + 1]);
        const double w = std::sqrt(z);
        // Limits of the change of speed, and of the change of that: those of the axis that is bound
        // most.
        const double binding = 0.999 * share_;
        double steepest = kInfinity;
        double sharpest = kInfinity;
        const auto bent = [&](const SpeedBound& b) {
            return std::abs(b.third) * z * w + 3 * std::abs(b.second) * w * steepest;
        };
        for (std::size_t i = 0; i < count; ++i) {
            const SpeedBound& b = bounds_[i];
            steepest = std::min(
                steepest, (share_ * b.acceleration + std::abs(b.second) * z) / std::abs(b.first));
        }
        for (std::size_t i = 0; i < count; ++i) {
            const SpeedBound& b = bounds_[i];
            sharpest = std::min(sharpest, (share_ * b.jerk + bent(b)) / std::abs(b.first));
        }
        for (std::size_t i = 0; i < count; ++i) {
            const SpeedBound& b = bounds_[i];
            if (std::abs(b.second) * z + std::abs(b.first) * steepest > binding * b.acceleration) {
                addAcceleration(b, in);
            }
            if (bent(b) + std::abs(b.first) * sharpest > binding * b.jerk) {
                addJerk(b, in);
            }
        }
    }

    void addAcceleration(const SpeedBound& bound, const Interval& in) {
        const Stencil bent = in.z * bound.second;
        const Stencil driven = in.slope * (bound.first / 2);
        const double limit = share_ * bound.acceleration;
        add(bent + driven, limit);
        add((bound.lengths ? bent : bent * -1) + driven * -1, limit);
    }

    void addJerk(const SpeedBound& bound, const Interval& in) {
        const Stencil bent = in.z * bound.third;
        const Stencil turning = in.slope * (1.5 * bound.second);
        const Stencil driven = in.bend * (bound.first / 2);
        const double limit = share_ * bound.jerk;
        const auto addOne = [&](const Stencil& sum) {
            rows_.push_back({interval_, sum, limit, in.z, true});
        };
        addOne(bent + turning + driven);
        addOne((bound.lengths ? bent : bent * -1) + turning * -1 + driven * -1);
        if (bound.lengths && bound.second > 0) {
            addOne(bent + turning + driven * -1);
            addOne(bent + turning * -1 + driven);
        }
    }

    void add(const Stencil& sum, double limit) {
        rows_.push_back({interval_, sum, limit, {}, false});
    }

    const Course& course_;
    double share_;
    std::size_t interval_ = 0;
    std::array<SpeedBound, kMaxAxes + 2> bounds_;
    std::vector<Row> rows_;
};

/// A symmetric matrix of five diagonals and a right side.
struct Banded {
    explicit Banded(std::size_t n) : rows(n) {}

    struct Line {
        double diagonal = 0;
        double next = 0;    ///< with the following unknown
        double second = 0;  ///< with the one after that
        double right = 0;
    };
    std::vector<Line> rows;

    void addProduct(std::size_t k, const Stencil& g, double weight) noexcept {
        rows[k].diagonal += weight * g.at * g.at;
        if (g.before != 0) {
            rows[k - 1].diagonal += weight * g.before * g.before;
            rows[k - 1].next += weight * g.before * g.at;
        }
        if (g.after != 0) {
            rows[k + 1].diagonal += weight * g.after * g.after;
            rows[k].next += weight * g.at * g.after;
        }
        if (g.before != 0 && g.after != 0) {
            rows[k - 1].second += weight * g.before * g.after;
        }
    }

    /// Leaves the solution in the right sides.
    void solve() noexcept {
        const std::size_t n = rows.size();
        for (std::size_t k = 0; k < n; ++k) {
            Line& a = rows[k];
            const double first = k + 1 < n ? a.next / a.diagonal : 0;
            const double second = k + 2 < n ? a.second / a.diagonal : 0;
            if (k + 1 < n) {
                rows[k + 1].diagonal -= first * a.next;
                rows[k + 1].next -= first * a.second;
                rows[k + 1].right -= first * a.right;
            }
            if (k + 2 < n) {
                rows[k + 2].diagonal -= second * a.second;
                rows[k + 2].right -= second * a.right;
            }
        }
        for (std::size_t k = n; k-- > 0;) {
            Line& a = rows[k];
            const double one = k + 1 < n ? a.next * rows[k + 1].right : 0;
            const double two = k + 2 < n ? a.second * rows[k + 2].right : 0;
            a.right = (a.right - one - two) / a.diagonal;
        }
    }
};

constexpr double kCurvature = 0.25;

/// Minimises the time with a barrier before each row, by Newton's method.
class Solver {
public:
    Solver(const Course& course, std::vector<Row> rows) : rows_(std::move(rows)) {
        double lowest = course.ceiling[course.first];
        for (std::size_t k = course.first; k < course.last; ++k) {
            ways_.push_back(course.places[k + 1] - course.places[k]);
            lowest = std::min(lowest, course.ceiling[k + 1]);
        }
        z_.assign(ways_.size(), lowest / 2);
    }

    std::vector<double> solve() {
        constexpr double accuracy = 0.01;
        constexpr double growth = 3;
        constexpr int most_steps = 100;
        const auto count = static_cast<double>(rows_.size());
        double weight = 0.1 * count / time(z_);
        for (int i = 0; i < most_steps; ++i) {
            const Step taken = step(weight);
            const bool heavy = weight * time(z_) * accuracy > count;
            if (taken.length == 0 || (heavy && taken.decrement < 0.3 * count)) {
                break;
            }
            weight *= !heavy && taken.length > 0.3 ? growth : 1;
        }
        return z_;
    }

private:
    double time(const std::vector<double>& z) const noexcept {
        double sum = 0;
        for (std::size_t k = 0; k < z.size(); ++k) {
            sum += ways_[k] / std::sqrt(z[k]);
        }
        return sum;
    }

    /// The objective of the minimisation; infinite where a row does not hold.
    double cost(const std::vector<double>& z, double weight) const noexcept {
        double product = 1;
        double sum = weight * time(z);
        for (const Row& row : rows_) {
            const double slack = slackOf(row, z);
            if (!(slack > 0)) {
                return kInfinity;
            }
            product *= slack / row.limit;
            if (product < 1e-200 || product > 1e200) {
                sum -= std::log(product);
                product = 1;
            }
        }
        return sum - std::log(product);
    }

    struct Step {
        double length = 0;  ///< share of Newton's step
        double decrement = 0;
    };

    /// One Newton step, shortened until it makes things better.
    Step step(double weight) {
        Banded system(z_.size());
        for (std::size_t k = 0; k < z_.size(); ++k) {
            const double slope = weight * ways_[k] / (2 * z_[k] * std::sqrt(z_[k]));
            system.rows[k].diagonal = kCurvature * slope / z_[k];
            system.rows[k].right = slope;
        }
        for (const Row& row : rows_) {
            const double slack = slackOf(row, z_);
            Stencil g = row.sum;
            if (row.jerk) {
                const double z = row.jerk_z.of(z_, row.interval);
                g = g + row.jerk_z * (row.limit / (2 * z * std::sqrt(z)));
            }
            system.addProduct(row.interval, g, 1 / (slack * slack));
            system.rows[row.interval].right -= g.at / slack;
            if (g.before != 0) {
                system.rows[row.interval - 1].right -= g.before / slack;
            }
            if (g.after != 0) {
                system.rows[row.interval + 1].right -= g.after / slack;
            }
        }
        std::vector<double> gradient(z_.size());
        for (std::size_t k = 0; k < z_.size(); ++k) {
            gradient[k] = system.rows[k].right;
        }
        system.solve();
        double length = 1;
        double decrement = 0;
        for (std::size_t k = 0; k < z_.size(); ++k) {
            decrement += gradient[k] * system.rows[k].right;
            length = std::min(length, -0.9 * z_[k] / std::min(system.rows[k].right, -1e-300));
        }
        const double before = cost(z_, weight);
        std::vector<double> next(z_.size());
        for (; length > 1e-6; length *= 0.5) {
            for (std::size_t k = 0; k < z_.size(); ++k) {
                next[k] = z_[k] + length * system.rows[k].right;
            }
            if (cost(next, weight) < before) {
                z_ = next;
                return {length, decrement};
            }
        }
        return {0, decrement};
    }

    std::vector<Row> rows_;
    std::vector<double> ways_;
    std::vector<double> z_;
};

}  // namespace

std::vector<CourseSpeed> fastestCourse(const Course& course, double share) {
    Solver solver(course, Rows(course, share).take());
    const std::vector<double> c = solver.solve();
    std::vector<CourseSpeed> speeds(course.first + 1, {c.front(), 0});
    for (std::size_t k = course.first; k < course.last; ++k) {
        const Interval in = intervalAt(course, k);
        const std::size_t n = k - course.first;
        speeds.push_back({in.z_end.of(c, n), in.slope_end.of(c, n) / 2});
    }
    speeds.resize(course.places.size(), {c.back(), 0});
    return speeds;
}

}  // namespace metier::motion
