#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "metier/motion/planner.hpp"

namespace metier::motion {

/// Random motions, many of them degenerate, each planned and sampled. Each depends on the seed and
/// on its number alone, so that one of them can be repeated.
class PlanFuzz {
public:
    /// \param models all that motions are planned for; must outlive this
    /// \param first number of the first motion
    PlanFuzz(const std::vector<RobotModel>& models, std::uint64_t seed, std::uint64_t first = 0)
        : models_(models), seed_(seed), number_(first) {}

    /// Plans one motion and samples it.
    /// \return what is wrong with it, with its robot and what was asked for; empty: nothing
    std::string next();

    int planned() const noexcept { return planned_; }
    /// Largest share of a limit that any plan used, by the limit's name.
    const std::map<std::string, double>& shares() const noexcept { return shares_; }

private:
    double between(double low, double high);
    /// Between `low` and `high` with an even logarithm.
    double anySize(double low, double high);
    bool oneOf(int count) { return std::uniform_int_distribution<int>(1, count)(random_) == 1; }
    Eigen::Vector3d anyDirection();
    motion::Pose anyStep();
    JointVector anyStart();
    void limit(LinRequest& request);
    PathRequest anyPath();
    PtpRequest anyPtp();
    std::string check(const Planned<Trajectory>& planned, const struct ToolLimits& tool,
                      const JointVector& start);
    /// Four set-points from `begin`, `step` apart [s].
    std::string checkAt(const Trajectory& plan, double begin, double step, const ToolLimits& tool);

    const std::vector<RobotModel>& models_;
    std::uint64_t seed_;
    std::uint64_t number_;  // of the next motion
    std::mt19937_64 random_;
    const RobotModel* model_ = nullptr;
    int planned_ = 0;
    std::map<std::string, double> shares_;
};

}  // namespace metier::motion
