// Inverse kinematics: all solutions, the nearest one, and Levenberg-Marquardt.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "closed_form.hpp"
#include "metier/motion/kinematics.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::motion {

namespace {

using Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kTwoPi = 2 * std::numbers::pi;
/// A solution this close beyond a limit is on it [rad].
constexpr double kLimitRounding = 1e-10;
/// Largest error of a solution, position [m] and rotation [rad].
constexpr double kResidual = 1e-10;
constexpr double kNumericResidual = 1e-9;
constexpr int kIterations = 40;
constexpr int kRefinements = 20;
constexpr int kRestarts = 400;

/// Position and rotation (short way) from one transform to another.
Vector6 errorBetween(const Transform& from, const Transform& to) noexcept {
    Vector6 error;
    error.head<3>() = to.translation - from.translation;
    const Matrix3d turn = to.rotation * from.rotation.transpose();
    const Eigen::Vector3d twice_sine(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0),
                                     turn(1, 0) - turn(0, 1));
    const double sine = 0.5 * twice_sine.norm();
    const double cosine = 0.5 * (turn.trace() - 1.0);
    if (cosine > 0.0) {
        const double scale = sine < 1e-8 ? 0.5 : 0.5 * std::asin(std::min(sine, 1.0)) / sine;
        error.tail<3>() = scale * twice_sine;
    } else {
        error.tail<3>() = toRotationVector(Eigen::Quaterniond(turn));
    }
    return error;
}

Transform toTransform(const Pose& pose) {
    return {pose.rotation.toRotationMatrix(), pose.translation};
}

/// Turns each axis by whole turns into [-pi, pi).
JointVector wrapped(JointVector joints) noexcept {
    for (double& angle : joints) {
        angle -= kTwoPi * std::floor((angle + std::numbers::pi) / kTwoPi);
    }
    return joints;
}

ClosedFormSolutions solveClosedForm(IkKind kind, const ZeroPosition& zero,
                                    const ClosedFormQuery& query) noexcept {
    switch (kind) {
        case IkKind::three_parallel_axes:
            return solveThreeParallelAxes(zero, query);
        case IkKind::spherical_wrist:
            return solveSphericalWrist(zero, query);
        case IkKind::arm_angle:
            return solveArmAngle(zero, query);
        case IkKind::numeric:
            break;
    }
    return {};
}

/// Reports whether a solution, each axis in (-pi, pi], is among the solutions already.
bool contains(const JointSolutions& solutions, const JointVector& other) noexcept {
    constexpr double same = 1e-6;  // [rad]
    return std::any_of(solutions.begin(), solutions.end(), [&](const JointVector& solution) {
        double farthest = 0;
        for (std::size_t i = 0; i < other.size(); ++i) {
            farthest = std::max(farthest, std::abs(std::remainder(solution[i] - other[i], kTwoPi)));
        }
        return farthest < same;
    });
}

struct Range {
    double lower;
    double upper;
};

/// Joint limits narrowed by the bounds.
Range rangeOf(const JointLimits& limits, const AxisBounds& bounds, std::size_t axis) noexcept {
    if (!bounds.isSet()) {
        return {limits.lower, limits.upper};
    }
    return {std::max(limits.lower, bounds.lower[axis]), std::min(limits.upper, bounds.upper[axis])};
}

/// The turn of `angle` by whole turns that lies in the range, nearest to `reference`; the one
/// nearest to the range if none does.
double turnInto(double angle, double reference, const Range& range) noexcept {
    double turned = angle + kTwoPi * std::round((reference - angle) / kTwoPi);
    if (turned > range.upper + kLimitRounding) {
        turned -= kTwoPi * std::ceil((turned - range.upper - kLimitRounding) / kTwoPi);
    } else if (turned < range.lower - kLimitRounding) {
        turned += kTwoPi * std::ceil((range.lower - kLimitRounding - turned) / kTwoPi);
    }
    if (std::abs(turned - range.upper) <= kLimitRounding) {
        return std::min(turned, range.upper);
    }
    return std::abs(turned - range.lower) <= kLimitRounding ? std::max(turned, range.lower)
                                                            : turned;
}

/// A small generator of our own: the same numbers on every machine.
class Random {
public:
    double between(double low, double high) noexcept {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return low + (high - low) * static_cast<double>(state_ >> 11) * 0x1p-53;
    }

private:
    std::uint64_t state_ = 0x9E3779B97F4A7C15ULL;
};

/// Chooses among solutions; remembers why the others were not taken.
class NearestChoice {
public:
    NearestChoice(const Kinematics& kinematics, const IkRequest& request) noexcept
        : kinematics_(kinematics), request_(request) {}

    void offer(const JointVector& solution) noexcept {
        JointVector turned(solution.size());
        double cost = 0;
        for (std::size_t i = 0; i < solution.size(); ++i) {
            const JointLimits& limits = kinematics_.limits(i);
            const Range range = rangeOf(limits, request_.bounds, i);
            turned[i] = turnInto(solution[i], request_.reference[i], range);
            if (turned[i] < range.lower || turned[i] > range.upper) {
                noteViolation(i, turned[i], range);
                return;
            }
            cost = std::max(cost, std::abs(turned[i] - request_.reference[i]) / limits.velocity);
        }
        if (cost < best_cost_) {
            best_cost_ = cost;
            best_ = turned;
        }
    }

    void offer(const JointSolutions& solutions) noexcept {
        for (const JointVector& solution : solutions) {
            offer(solution);
        }
    }

    bool found() const noexcept { return !best_.empty(); }
    const JointVector& best() const noexcept { return best_; }
    double cost() const noexcept { return best_cost_; }
    bool anyOutside() const noexcept { return violation_ < kNone; }
    std::string violationText() const {
        return fmt::format("unreachable: axis {} would be at {:.4f} rad, {} limit {:.4f} rad",
                           axis_ + 1, value_, value_ > limit_ ? "over" : "under", limit_);
    }

private:
    static constexpr double kNone = std::numeric_limits<double>::infinity();

    void noteViolation(std::size_t axis, double value, const Range& range) noexcept {
        const double over = std::max(value - range.upper, range.lower - value);
        if (over < violation_) {
            violation_ = over;
            axis_ = axis;
            value_ = value;
            limit_ = value > range.upper ? range.upper : range.lower;
        }
    }

    const Kinematics& kinematics_;
    const IkRequest& request_;
    JointVector best_;
    double best_cost_ = kNone;
    double violation_ = kNone;
    std::size_t axis_ = 0;
    double value_ = 0;
    double limit_ = 0;
};

/// A joint position, and how far it is from the reference of a request.
struct Candidate {
    JointVector position;
    double cost = 0;
};

/// The arm angles round the preferred one, nearest first, then a finer grid.
void searchArmAngles(const Kinematics& kinematics, const Pose& pose, const IkRequest& request,
                     NearestChoice& choice) {
    for (const int count : {72, 720}) {
        const double preferred = kinematics.redundancyAngle(request.reference);
        for (int i = 1; i <= count / 2 && !choice.found(); ++i) {
            const double step = kTwoPi * i / count;
            choice.offer(kinematics.allSolutions(pose, request.reference, preferred + step));
            choice.offer(kinematics.allSolutions(pose, request.reference, preferred - step));
        }
    }
}

void searchNumerically(const Kinematics& kinematics, const Pose& pose, const IkRequest& request,
                       NearestChoice& choice) {
    Random random;
    JointVector seed = request.reference;
    for (int restart = 0; restart < kRestarts && !choice.found(); ++restart) {
        if (const auto solution = kinematics.solveNumerically(pose, seed, kIterations)) {
            choice.offer(*solution);
        }
        for (std::size_t i = 0; i < seed.size(); ++i) {
            const Range range = rangeOf(kinematics.limits(i), request.bounds, i);
            seed[i] = random.between(std::max(range.lower, -std::numbers::pi),
                                     std::min(range.upper, std::numbers::pi));
        }
    }
}

Result<void> checkRequest(const Kinematics& kinematics, const Pose& pose,
                          const IkRequest& request) {
    const std::size_t axes = kinematics.axisCount();
    if (request.reference.size() != axes ||
        (request.bounds.isSet() &&
         (request.bounds.lower.size() != axes || request.bounds.upper.size() != axes))) {
        return fail(Errc::invalid_argument,
                    fmt::format("reference or axis bounds have not {} axes", axes));
    }
    if (!request.reference.allFinite() || !pose.translation.allFinite() ||
        !pose.rotation.coeffs().allFinite() || !request.bounds.lower.allFinite() ||
        !request.bounds.upper.allFinite() || !std::isfinite(request.redundancy_angle.value_or(0))) {
        return fail(Errc::invalid_argument,
                    "pose, reference, axis bounds or arm angle are not finite");
    }
    if (std::abs(pose.rotation.norm() - 1.0) > 1e-6) {
        return fail(Errc::invalid_argument, "the pose's quaternion is not a unit quaternion");
    }
    return {};
}

}  // namespace

std::optional<JointVector> Kinematics::solveNumerically(const Pose& base_from_flange,
                                                        const JointVector& seed,
                                                        int max_iterations) const noexcept {
    constexpr double floor_error = 1e-12;
    const Transform target = toTransform(base_from_flange);
    JointVector q = seed;
    Jacobian j;
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= max_iterations; ++i) {
        const Vector6 error = errorBetween(forward(q, j), target);
        const double square = error.squaredNorm();
        const bool close = square < kNumericResidual * kNumericResidual;
        if (close && (square < floor_error * floor_error || square > 0.25 * before)) {
            return q;
        }
        before = square;
        Matrix6 system = j * j.transpose();
        system.diagonal().array() += 0.5 * square + 1e-14;
        q.view() += j.transpose() * system.llt().solve(error);
    }
    return std::nullopt;
}

JointSolutions Kinematics::allSolutions(
    const Pose& base_from_flange, const JointVector& reference,
    const std::optional<double>& redundancy_angle) const noexcept {
    if (kind_ != IkKind::numeric) {
        return closedForm(base_from_flange, reference,
                          redundancy_angle.value_or(redundancyAngle(reference)));
    }
    JointSolutions result;
    if (auto solution = solveNumerically(base_from_flange, reference, kIterations)) {
        result.add(wrapped(*solution));
    }
    return result;
}

JointSolutions Kinematics::closedForm(const Pose& base_from_flange, const JointVector& reference,
                                      double redundancy_angle) const noexcept {
    const ClosedFormQuery query{toTransform(base_from_flange), reference, redundancy_angle};
    const ClosedFormSolutions found = solveClosedForm(kind_, zero_, query);
    JointSolutions result;
    for (std::size_t i = 0; i < found.solutions.size(); ++i) {
        JointVector solution = found.solutions[i];
        if (calibrated_) {
            const auto refined = solveNumerically(base_from_flange, solution, kRefinements);
            if (refined && !contains(result, wrapped(*refined))) {
                result.add(wrapped(*refined));
            }
            continue;
        }
        if (found.delicate[i] && !polish(query.base_from_flange, solution)) {
            continue;
        }
        result.add(solution);
    }
    return result;
}

std::optional<ReachMiss> Kinematics::outOfReach(const Pose& base_from_flange,
                                                const JointVector& reference) const noexcept {
    constexpr double calibration = 0.02;  // the exact arm may reach so much less [m]
    const double rounding = calibrated_ ? calibration : kResidual;
    if (kind_ == IkKind::numeric) {
        const double distance = leastDistanceFromAxis2(base_from_flange.translation);
        return distance > reach_ + rounding
                   ? std::optional(ReachMiss{"the flange", 1, distance, reach_})
                   : std::nullopt;
    }
    const ClosedFormSolutions found = solveClosedForm(
        kind_, zero_, {toTransform(base_from_flange), reference, redundancyAngle(reference)});
    const bool missed = found.solutions.empty() && found.miss && found.miss->excess() > rounding;
    return missed ? found.miss : std::nullopt;
}

JointVector Kinematics::solutionNear(const Pose& base_from_flange, const JointVector& guess,
                                     double redundancy_angle) const noexcept {
    if (kind_ == IkKind::numeric || calibrated_) {
        return solveNumerically(base_from_flange, guess, kIterations).value_or(JointVector{});
    }
    JointVector best;
    double least = std::numeric_limits<double>::infinity();
    for (const JointVector& solution : closedForm(base_from_flange, guess, redundancy_angle)) {
        JointVector turned(solution.size());
        double cost = 0;
        for (std::size_t i = 0; i < solution.size(); ++i) {
            turned[i] = solution[i] + kTwoPi * std::round((guess[i] - solution[i]) / kTwoPi);
            cost = std::max(cost, std::abs(turned[i] - guess[i]));
        }
        if (cost < least) {
            least = cost;
            best = turned;
        }
    }
    return best;
}

bool Kinematics::polish(const Transform& target, JointVector& solution) const noexcept {
    constexpr int steps = 3;
    Jacobian j;
    for (int i = 0; i <= steps; ++i) {
        const Vector6 error = errorBetween(forward(solution, j), target);
        if (error.squaredNorm() < 0.01 * kResidual * kResidual) {
            return true;
        }
        if (i == steps) {
            return error.squaredNorm() < kResidual * kResidual;
        }
        Matrix6 system = j * j.transpose();
        system.diagonal().array() += 1e-14;
        solution.view() += j.transpose() * system.llt().solve(error);
    }
    return false;
}

Result<JointVector> Kinematics::inverse(const Pose& base_from_flange,
                                        const IkRequest& request) const {
    return search(base_from_flange, request, kind_);
}

std::vector<JointVector> Kinematics::inverseAll(const Pose& base_from_flange,
                                                const IkRequest& request) const {
    if (!checkRequest(*this, base_from_flange, request)) {
        return {};
    }
    std::vector<Candidate> candidates;
    for (const auto& solution :
         allSolutions(base_from_flange, request.reference, request.redundancy_angle)) {
        NearestChoice choice(*this, request);
        choice.offer(solution);
        if (choice.found()) {
            candidates.push_back({choice.best(), choice.cost()});
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.cost < b.cost; });
    std::vector<JointVector> positions;
    std::transform(candidates.begin(), candidates.end(), std::back_inserter(positions),
                   [](const auto& each) { return each.position; });
    return positions;
}

Result<JointVector> Kinematics::inverseNumerically(const Pose& base_from_flange,
                                                   const IkRequest& request) const {
    return search(base_from_flange, request, IkKind::numeric);
}

Result<JointVector> Kinematics::search(const Pose& base_from_flange, const IkRequest& request,
                                       IkKind method) const {
    METIER_TRY(checkRequest(*this, base_from_flange, request));
    NearestChoice choice(*this, request);
    if (method != IkKind::numeric) {
        choice.offer(
            closedForm(base_from_flange, request.reference,
                       request.redundancy_angle.value_or(redundancyAngle(request.reference))));
    }
    if (!choice.found() && !choice.anyOutside()) {
        if (const auto miss = outOfReach(base_from_flange, request.reference)) {
            return fail(Errc::unreachable, toString(*miss));
        }
    }
    if (!choice.found() && (method == IkKind::numeric || calibrated_)) {
        searchNumerically(*this, base_from_flange, request, choice);
    }
    if (!choice.found() && method == IkKind::arm_angle && !request.redundancy_angle) {
        searchArmAngles(*this, base_from_flange, request, choice);
    }
    if (choice.found()) {
        return choice.best();
    }
    if (choice.anyOutside()) {
        return fail(Errc::unreachable, choice.violationText());
    }
    return fail(Errc::unreachable, "unreachable: no joint position found that has this pose");
}

}  // namespace metier::motion
