#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::cell {

/// Settings of one device, as a cell file or a command line gives them: names with values. Who
/// knows the device asks for each by name; finish() tells everything that is wrong at once, unknown
/// names too.
///
/// Threading: one thread.
class Settings {
public:
    using Value = std::variant<double, bool, std::string, std::vector<double>>;

    Settings() = default;
    /// \param place stands before each message, as "demo.toml:12: server[0].driver"
    Settings(std::string place, std::map<std::string, Value> values);

    bool has(std::string_view name) const;
    /// What stands behind "PREFIX." in the names: of "part.cube" and "part.rod" cube and rod.
    std::vector<std::string> namesUnder(std::string_view prefix) const;
    /// Noted if missing or of another type.
    std::string text(std::string_view name) const;
    // Noted if of another type.
    std::string textOr(std::string_view name, std::string fallback) const;
    bool flagOr(std::string_view name, bool fallback) const;
    /// Also noted if not within [low, high].
    double numberOr(std::string_view name, double fallback, double low, double high) const;
    /// Also noted if it is not `count` numbers. Empty if absent.
    std::vector<double> numbersOr(std::string_view name, std::vector<double> fallback,
                                  std::size_t count) const;
    /// Notes that the value is not acceptable, and why.
    void reject(std::string_view name, std::string_view why) const;

    /// Gives a value, as a command line does: over what the file says.
    void set(std::string name, Value value);

    /// Errors: invalid_argument with a line "place.name: why" for each thing that is wrong.
    Result<void> finish() const;

private:
    template <typename T>
    const T* find(std::string_view name, std::string_view kind) const;

    std::string place_;
    std::map<std::string, Value, std::less<>> values_;
    // Reading notes what was asked for and what is wrong.
    mutable std::set<std::string, std::less<>> asked_;
    mutable std::vector<std::string> problems_;
};

}  // namespace metier::cell
