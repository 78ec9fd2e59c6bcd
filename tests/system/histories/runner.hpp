#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "world.hpp"

namespace metier::system_tests {

/// Makes the model that a history is compared with, which begins with these results.
using ModelMaker =
    std::function<std::unique_ptr<Taker>(const std::array<std::string, kSkills>& results)>;
std::unique_ptr<Taker> makeModel(const std::array<std::string, kSkills>& results);

/// A step after which server and model differ.
struct Divergence {
    std::size_t step = 0;
    std::string text;  ///< the expected and the real view
};

/// Takes a history on the server and on the model, and compares replies and the clients' view after
/// each step.
/// \return the first step after which they differ
std::optional<Divergence> findDivergence(World& world, const History& history,
                                         const ModelMaker& make_model = makeModel);

/// The shortest history found that still fails: no step of it can be left out. Steps that do not
/// need their client, skill or value have those of number 0.
History shrink(History history, const std::function<bool(const History&)>& fails);

/// The failing history, shrunk, as a person replays it, with what was expected there.
std::string explain(World& world, const History& history, const ModelMaker& make_model = makeModel);

}  // namespace metier::system_tests
