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

/// A value of any type. Each accessor returns nothing if the value is of another type; the caller
/// reports that with reject().
///
/// Valid as long as its TomlFile. Threading: one thread.
class TomlValue {
public:
    /// true or false.
    std::optional<bool> flag() const;
    /// A whole number.
    std::optional<std::int64_t> integer() const;
    /// A number, whole or not; nothing if it is not finite.
    std::optional<double> number() const;
    /// A string.
    std::optional<std::string> text() const;
    /// Whether it is a list.
    bool isList() const;
    /// Elements of a list, in order; empty if the value is no list.
    std::vector<TomlValue> items() const;
    /// A table; its keys must be read, too.
    std::optional<TomlTable> table() const;
    /// Line of the value in the file, counted from 1.
    std::uint32_t line() const;
    /// Notes that the value is not acceptable, and why; TomlFile::finish() reports it.
    void reject(std::string_view why) const;

private:
    friend class TomlFile;
    friend class TomlTable;
    struct Impl;
    explicit TomlValue(const Impl* impl) : impl_(impl) {}
    const Impl* impl_;  // owned by the file
};

/// One table of a TOML file. Reading never fails at once: an error is noted with file, line and
/// key, and a harmless value is returned; TomlFile::finish() reports all errors together.
///
/// A key that was never read is an error too, so a misspelt key is never ignored silently. Valid as
/// long as its TomlFile. Threading: one thread.
class TomlTable {
public:
    /// Reports whether the key exists. The key then counts as read.
    bool has(std::string_view key) const;
    /// The keys as the file spells them. This call does not count as reading them.
    std::vector<std::string> keys() const;
    /// The value of `key`, of any type; nothing if there is no such key.
    std::optional<TomlValue> value(std::string_view key) const;

    /// Required text. An error is noted, and "" returned, if it is missing or of another type; the
    /// same for those below, with 0 or an empty list.
    std::string text(std::string_view key) const;
    /// Required number; it must be finite.
    double number(std::string_view key) const;
    /// Required list of finite numbers.
    std::vector<double> numbers(std::string_view key) const;
    /// Required list of texts.
    std::vector<std::string> texts(std::string_view key) const;
    /// Required table.
    TomlTable table(std::string_view key) const;
    /// The tables of `[[key]]`; empty if there is none.
    std::vector<TomlTable> tables(std::string_view key) const;

    /// Text, or `fallback` if the key is missing. An error is noted if it is of another type; the
    /// same for those below.
    std::string textOr(std::string_view key, std::string fallback) const;
    /// A number >= 0; nothing if there is no such key. `unit` is for the error message.
    std::optional<double> amount(std::string_view key, std::string_view unit) const;
    /// Finite number, or `fallback`.
    double numberOr(std::string_view key, double fallback) const;

    /// Whole number within [low, high], both allowed, or `fallback`; another value is noted as an
    /// error.
    std::int64_t integerOr(std::string_view key, std::int64_t fallback, std::int64_t low,
                           std::int64_t high) const;
    /// true or false, or `fallback`.
    bool flagOr(std::string_view key, bool fallback) const;

    /// All values but those named in `taken`, for a reader that knows their names. A value of an
    /// inner table has a name with a point: "part.cube".
    Settings settings(std::initializer_list<std::string_view> taken) const;

    /// Notes that the value of `key` is not acceptable, and why; TomlFile::finish() reports it.
    void reject(std::string_view key, std::string_view why) const;
    /// "file:line", for messages about the whole table.
    std::string place() const;
    /// Line at which the table begins, counted from 1.
    std::uint32_t line() const;

private:
    friend class TomlFile;
    friend class TomlValue;
    struct Impl;
    explicit TomlTable(const Impl* impl) : impl_(impl) {}
    const Impl* impl_;  // owned by the file
};

/// A TOML file that is read table by table. It owns what its tables and values refer to:
///
///     auto file = TomlFile::load("part.toml");
///     const double width = file->root().number("width");
///     METIER_TRY(file->finish());  // all errors together
///
/// Threading: one thread.
class TomlFile {
public:
    /// Reads and parses a file; waits for the disk.
    /// Errors: not_found if the file cannot be read, invalid_argument if it is not TOML (the text
    ///         names file, line and column).
    static Result<TomlFile> load(const std::filesystem::path& path);
    /// Parses a text. Errors: invalid_argument.
    /// \param name stands for the file in messages
    static Result<TomlFile> parse(std::string_view text, std::string name);

    TomlFile(TomlFile&&) noexcept;
    TomlFile& operator=(TomlFile&&) noexcept;
    ~TomlFile();

    /// The table of the whole file.
    TomlTable root() const;
    /// Text of the file, comments included. Valid as long as the file.
    const std::string& content() const noexcept;
    /// Notes an error in a line that only the caller can see; finish() reports it.
    void note(std::uint32_t line, std::string_view what, std::string_view why) const;
    /// Ends the reading and reports what was noted.
    /// Errors: invalid_argument with one line for each error: "file:line: key: why".
    Result<void> finish() const;

private:
    struct Impl;
    friend class TomlTable;
    friend class TomlValue;
    explicit TomlFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::cell
