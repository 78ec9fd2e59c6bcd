#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "metier/composition/definition_file.hpp"

namespace metier::composition {

namespace {

class Sorter {
public:
    explicit Sorter(std::vector<Definition> definitions)
        : given_(std::move(definitions)), taken_(given_.size()) {}

    Result<std::vector<Definition>> sort() && {
        for (std::size_t i = 0; i < given_.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (given_[i].name == given_[j].name || given_[i].type == given_[j].type) {
                    return fail(
                        Errc::invalid_argument,
                        fmt::format(
                            "{} and {} both declare {}", given_[j].file, given_[i].file,
                            given_[i].name == given_[j].name ? given_[i].name : given_[i].type));
                }
            }
        }
        for (std::size_t i = 0; i < given_.size(); ++i) {
            METIER_TRY(take(i));
        }
        return std::move(sorted_);
    }

private:
    Result<void> take(std::size_t index) {
        if (taken_[index]) {
            return {};
        }
        const auto& definition = given_[index];
        const bool around =
            std::find(joint_path_.begin(), joint_path_.end(), definition.type) != joint_path_.end();
        joint_path_.push_back(definition.type);
        if (around) {
            return fail(Errc::invalid_argument,
                        fmt::format("{}: {}: uses itself: {}", definition.file, definition.name,
                                    fmt::join(joint_path_, " uses ")));
        }
        for (const auto& use : definition.uses) {
            METIER_TRY(takeType(use.type));
        }
        joint_path_.pop_back();
        taken_[index] = true;
        sorted_.push_back(given_[index]);
        return {};
    }

    /// Takes the definitions of a type.
    Result<void> takeType(const std::string& type) {
        for (std::size_t index = 0; index < given_.size(); ++index) {
            if (given_[index].type == type) {
                METIER_TRY(take(index));
            }
        }
        return {};
    }

    std::vector<Definition> given_;
    std::vector<bool> taken_;
    std::vector<std::string> joint_path_;  // types, from the first to the one looked at
    std::vector<Definition> sorted_;
};

}  // namespace

Result<std::vector<Definition>> inOrderOfUse(std::vector<Definition> definitions) {
    return Sorter(std::move(definitions)).sort();
}

}  // namespace metier::composition
