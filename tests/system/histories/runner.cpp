#include "runner.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace metier::system_tests {

namespace {

using Lines = std::vector<std::string>;

std::string difference(const Step& step, const Lines& expected, const Lines& seen) {
    return fmt::format("after: {}\nexpected:\n  {}\nseen:\n  {}\n", toString(step),
                       fmt::join(expected, "\n  "), fmt::join(seen, "\n  "));
}

Lines takeAndLook(Taker& taker, const Step& step) {
    Lines lines{taker.take(step)};
    auto seen = taker.seen();
    std::move(seen.begin(), seen.end(), std::back_inserter(lines));
    return lines;
}

/// Leaves out pieces of `size` steps, as long as the rest still fails.
bool leaveOut(History& history, std::size_t size,
              const std::function<bool(const History&)>& fails) {
    bool shorter = false;
    for (std::size_t begin = 0; begin < history.size();) {
        const auto end = std::min(begin + size, history.size());
        History rest = history;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(begin),
                   rest.begin() + static_cast<std::ptrdiff_t>(end));
        if (fails(rest)) {
            history = std::move(rest);
            shorter = true;
        } else {
            begin = end;
        }
    }
    return shorter;
}

void simplify(History& history, const std::function<bool(const History&)>& fails) {
    for (auto& step : history) {
        for (auto part : {&Step::client, &Step::skill}) {
            const auto before = std::exchange(step.*part, 0);
            if (before != 0 && !fails(history)) {
                step.*part = before;
            }
        }
        const auto value = std::exchange(step.value, 0);
        if (value != 0 && !fails(history)) {
            step.value = value;
        }
    }
}

}  // namespace

std::unique_ptr<Taker> makeModel(const std::array<std::string, kSkills>& results) {
    return std::make_unique<Model>(results);
}

std::optional<Divergence> findDivergence(World& world, const History& history,
                                         const ModelMaker& make_model) {
    const auto model = make_model(world.beginAnew());
    for (std::size_t i = 0; i < history.size(); ++i) {
        const auto expected = takeAndLook(*model, history[i]);
        const auto seen = takeAndLook(world, history[i]);
        if (seen != expected) {
            return Divergence{i, difference(history[i], expected, seen)};
        }
    }
    return {};
}

History shrink(History history, const std::function<bool(const History&)>& fails) {
    for (std::size_t size = std::max<std::size_t>(history.size() / 2, 1); size > 0; size /= 2) {
        leaveOut(history, size, fails);
    }
    simplify(history, fails);
    while (leaveOut(history, 1, fails)) {
    }
    return history;
}

std::string explain(World& world, const History& history, const ModelMaker& make_model) {
    const auto shortest = shrink(history, [&](const History& candidate) {
        return findDivergence(world, candidate, make_model).has_value();
    });
    const auto divergence = findDivergence(world, shortest, make_model);
    return fmt::format("the shortest of its kind, {} steps of {}:\n{}{}", shortest.size(),
                       history.size(), toString(shortest),
                       divergence ? divergence->text : "(it does not fail each time)");
}

}  // namespace metier::system_tests
