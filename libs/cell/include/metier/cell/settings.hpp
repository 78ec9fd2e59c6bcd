#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::cell {

/// Settings of one device from a cell file or a command line: names with values. The driver reads
/// each by its name; finish() reports all errors together, including names that were never read:
///
///     const double force = settings.numberOr("force", 20.0, 0.0, 80.0);
///     METIER_TRY(settings.finish());
///
/// Threading: one thread; reading notes the names, also through a const reference.
class Settings {
public:
    /// Value of a setting; a whole number is a double, too.
    using Value = std::variant<double, bool, std::string, std::vector<double>>;

    /// No settings: every value is its default.
    Settings() = default;
    /// \param place begin of each error message, such as "demo.toml:12: server[0].driver"
    Settings(std::string place, std::map<std::string, Value> values);

    /// Reports whether there is a value of that name. The name then counts as read.
    bool has(std::string_view name) const;
    /// Names after "PREFIX.": with the prefix "part", "part.cube" and "part.rod" give cube and rod.
    std::vector<std::string> namesUnder(std::string_view prefix) const;
    /// Required text. An error is noted if it is missing or of another type.
    std::string text(std::string_view name) const;
    /// Text, or `fallback` if it is missing. An error is noted if it is of another type.
    std::string textOr(std::string_view name, const std::string& fallback) const;
    /// true or false, or `fallback` if it is missing. An error is noted if it is of another type.
    bool flagOr(std::string_view name, bool fallback) const;
    /// Number, or `fallback` if it is missing. An error is noted if it is of another type or not
    /// within [low, high].
    double numberOr(std::string_view name, double fallback, double low, double high) const;
    /// List of numbers, or `fallback` if it is missing. An error is noted if it is of another type
    /// or has not exactly `count` numbers.
    std::vector<double> numbersOr(std::string_view name, std::vector<double> fallback,
                                  std::size_t count) const;
    /// Notes that the value is not acceptable, and why; finish() reports it.
    void reject(std::string_view name, std::string_view why) const;

    /// Sets a value, for example from a command line; it replaces the value of the file.
    void set(std::string name, Value value);

    /// Ends the reading and reports what was noted.
    /// Errors: invalid_argument with a line "place.name: why" for each error.
    Result<void> finish() const;

private:
    template <typename T>
    const T* find(std::string_view name, std::string_view kind) const;

    std::string place_;
    std::map<std::string, Value, std::less<>> values_;
    // Reading notes the names that were read, and the errors.
    mutable std::set<std::string, std::less<>> asked_;
    mutable std::vector<std::string> problems_;
};

}  // namespace metier::cell
