#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace metier::urscript {

/// Three numbers along x, y, z.
using Vector3 = std::array<double, 3>;
/// One number per joint, axis 1 first; or x, y, z and about x, y, z.
using Vector6 = std::array<double, 6>;

/// A pose `p[x, y, z, rx, ry, rz]`: x, y, z [m] and the rotation vector rx, ry, rz [rad].
struct Pose {
    /// x, y, z [m], rx, ry, rz [rad].
    Vector6 value{};
    friend bool operator==(const Pose&, const Pose&) = default;
};

class Value;

/// A list with value semantics: a copy is independent of the original. Copies share their elements
/// until one of them is changed.
///
/// Threading: as Value. weight(), characters() and depth() are kept up to date, so that an
/// interpreter can bound the memory of a script without counting.
class List {
public:
    /// An empty list.
    List() = default;
    /// A list with these elements; the vector is not copied.
    explicit List(std::vector<Value> elements);

    /// All elements, in order; valid until the list is changed.
    const std::vector<Value>& elements() const;
    /// Number of elements.
    std::size_t size() const;
    /// Number of values in this list and in the lists inside it.
    std::size_t weight() const { return weight_; }
    /// Number of characters of the strings in this list and in the lists inside it.
    std::size_t characters() const { return characters_; }
    /// Depth of nested lists, at least 1: 1 for a list of numbers.
    int depth() const { return depth_; }
    /// Replaces an element; copies of the list keep theirs.
    /// Copies the elements first if another list shares them; depth() never falls by it.
    /// \param index less than size(), which is not checked
    void set(std::size_t index, Value value);

private:
    std::shared_ptr<std::vector<Value>> elements_;  // shared by copies until one is changed
    std::size_t weight_ = 0;
    std::size_t characters_ = 0;
    int depth_ = 1;
};

/// A value of a script. Integers have 32 bits, as in the controller.
///
/// Threading: one thread, since copies share their elements.
class Value {
public:
    /// Content; std::monostate is a variable without a value.
    using Data = std::variant<std::monostate, bool, std::int32_t, double, std::string, List, Pose>;

    /// No value.
    Value() = default;
    Value(bool value) : data_(value) {}                      // NOLINT: a value is a value
    Value(std::int32_t value) : data_(value) {}              // NOLINT
    Value(double value) : data_(value) {}                    // NOLINT
    Value(std::string value) : data_(std::move(value)) {}    // NOLINT
    Value(const char* value) : data_(std::string(value)) {}  // NOLINT
    Value(List value) : data_(std::move(value)) {}           // NOLINT
    Value(const Pose& value) : data_(value) {}               // NOLINT
    // A list of six numbers, not a pose.
    Value(const Vector6& numbers);                                            // NOLINT
    Value(std::vector<Value> elements) : data_(List(std::move(elements))) {}  // NOLINT

    /// Content, to be visited.
    const Data& data() const { return data_; }
    /// Content to be changed; List::set() makes a list independent of its copies.
    Data& data() { return data_; }
    /// Content of that type, or nullptr.
    /// No conversion: an integer is no double.
    template <typename T>
    const T* get() const {
        return std::get_if<T>(&data_);
    }
    template <typename T>
    T* get() {
        return std::get_if<T>(&data_);
    }
    /// Whether there is no value.
    bool isNone() const { return data_.index() == 0; }
    /// Whether it is an integer or a floating-point number.
    bool isNumber() const { return get<std::int32_t>() != nullptr || get<double>() != nullptr; }
    /// The number; 0 if the value is no number.
    /// Integers are converted exactly; a bool is no number.
    double number() const;
    /// "none", "bool", "int", "float", "string", "list" or "pose".
    /// Valid for ever.
    std::string_view typeName() const;
    /// Text in the form of textmsg, str_cat and to_str: True, 1, 0.5, [1, 2], p[0, 0, 0, 0, 0, 0].
    /// Floating-point numbers have six significant digits, strings no quotes, none is None.
    std::string text() const;

private:
    Data data_;
};

inline std::size_t List::size() const {
    return elements_ ? elements_->size() : 0;
}

}  // namespace metier::urscript
