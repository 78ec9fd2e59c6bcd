#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/cell/settings.hpp"

namespace metier::cell {

class TomlTable;

/// A value whose kind is up to the file: what it is not, it gives nothing for.
///
/// Valid as long as its TomlFile. Threading: one thread.
class TomlValue {
public:
    std::optional<bool> flag() const;
    std::optional<std::int64_t> integer() const;
    /// Also of a whole number; nothing if it is not finite.
    std::optional<double> number() const;
    std::optional<std::string> text() const;
    bool isList() const;
    /// Of a list; empty for all else.
    std::vector<TomlValue> items() const;
    std::optional<TomlTable> table() const;
    /// Where it stands, from 1.
    std::uint32_t line() const;
    /// Notes that it is not acceptable, and why.
    void reject(std::string_view why) const;

private:
    friend class TomlFile;
    friend class TomlTable;
    struct Impl;
    explicit TomlValue(const Impl* impl) : impl_(impl) {}
    const Impl* impl_;  // owned by the file
};

/// One table of a TOML file. Reading never fails at once: what is wrong is noted, with file, line
/// and key, and a harmless value is returned; TomlFile::finish() then tells everything that is
/// wrong.
///
/// A key that nobody asked for is an error too, so a misspelt key is never ignored silently.
/// Valid as long as its TomlFile. Threading: one thread.
class TomlTable {
public:
    bool has(std::string_view key) const;
    /// The keys as the file gives them; none of them counts as asked for by this.
    std::vector<std::string> keys() const;
    /// The value of `key`, whatever kind it is; nothing if there is none.
    std::optional<TomlValue> value(std::string_view key) const;

    /// Required values. Noted if missing or of another type.
    std::string text(std::string_view key) const;
    double number(std::string_view key) const;
    std::vector<double> numbers(std::string_view key) const;
    std::vector<std::string> texts(std::string_view key) const;
    TomlTable table(std::string_view key) const;
    /// The tables of `[[key]]`; empty if there is none.
    std::vector<TomlTable> tables(std::string_view key) const;

    /// Values with a default. Noted if present and of another type.
    std::string textOr(std::string_view key, std::string fallback) const;
    /// Nothing if there is no such key; under 0 is wrong.
    std::optional<double> amount(std::string_view key, std::string_view unit) const;
    double numberOr(std::string_view key, double fallback) const;

    /// Whole number within [low, high].
    std::int64_t integerOr(std::string_view key, std::int64_t fallback, std::int64_t low,
                           std::int64_t high) const;
    bool flagOr(std::string_view key, bool fallback) const;

    /// All values but those of `taken`, for whoever knows their names; those of tables within have
    /// names with a point: "part.cube".
    Settings settings(std::initializer_list<std::string_view> taken) const;

    /// Notes that the value of `key` is not acceptable, and why.
    void reject(std::string_view key, std::string_view why) const;
    /// "file:line", for messages about the whole table.
    std::string place() const;
    /// Where the table begins, from 1.
    std::uint32_t line() const;

private:
    friend class TomlFile;
    friend class TomlValue;
    struct Impl;
    explicit TomlTable(const Impl* impl) : impl_(impl) {}
    const Impl* impl_;  // owned by the file
};

/// A TOML file that is read table by table.
class TomlFile {
public:
    /// Errors: not_found if the file cannot be read, invalid_argument if it is not TOML
    /// (the text names file, line and column).
    static Result<TomlFile> load(const std::filesystem::path& path);
    /// The same from text; `name` stands for the file in messages.
    static Result<TomlFile> parse(std::string_view text, std::string name);

    TomlFile(TomlFile&&) noexcept;
    TomlFile& operator=(TomlFile&&) noexcept;
    ~TomlFile();

    TomlTable root() const;
    /// Notes what is wrong with a line for reasons that only its reader knows.
    void note(std::uint32_t line, std::string_view what, std::string_view why) const;
    /// Errors: invalid_argument with one line for each thing that is wrong: "file:line: key: why".
    Result<void> finish() const;

private:
    struct Impl;
    friend class TomlTable;
    friend class TomlValue;
    explicit TomlFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::cell
