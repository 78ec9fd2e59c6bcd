#include "operators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace metier::urscript {
namespace {

constexpr std::size_t kMostCharacters = 100'000;  // that one operation adds to a list

bool isComparison(Op op) {
    return op >= Op::equal && op <= Op::greater_equal;
}

std::string_view symbolOf(Op op) {
    return std::ranges::find(kBinaryOperators, op, &BinaryOperator::op)->symbol;
}

tl::unexpected<Error> mismatch(Op op, const Value& left, const Value& right) {
    return fail(Errc::type_mismatch, fmt::format("{} {} {} is not possible", left.typeName(),
                                                 symbolOf(op), right.typeName()));
}

/// Wraps a number to 32 bits: beyond one end it goes on at the other.
Value wrapped(std::int64_t value) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

Result<Value> ofIntegers(Op op, std::int64_t left, std::int64_t right) {
    if (right == 0 && (op == Op::divide || op == Op::remainder)) {
        return fail(Errc::invalid_argument, "division by zero");
    }
    switch (op) {
        case Op::add:
            return wrapped(left + right);
        case Op::subtract:
            return wrapped(left - right);
        case Op::multiply:
            return wrapped(left * right);
        case Op::remainder:
            return wrapped(left % right);
        default:
            return Value(static_cast<double>(left) / static_cast<double>(right));
    }
}

Result<Value> ofNumbers(Op op, double left, double right) {
    switch (op) {
        case Op::add:
            return Value(left + right);
        case Op::subtract:
            return Value(left - right);
        case Op::multiply:
            return Value(left * right);
        default:
            if (right == 0.0) {
                return fail(Errc::invalid_argument, "division by zero");
            }
            return Value(op == Op::divide ? left / right : std::fmod(left, right));
    }
}

template <typename T>
bool compared(Op op, const T& left, const T& right) {
    switch (op) {
        case Op::less:
            return left < right;
        case Op::less_equal:
            return left <= right;
        case Op::greater:
            return left > right;
        default:
            return left >= right;
    }
}

bool isEqual(const Value& left, const Value& right);

bool areEqual(const List& left, const List& right) {
    return left.size() == right.size() && std::equal(left.elements().begin(), left.elements().end(),
                                                     right.elements().begin(), isEqual);
}

/// A bool as a number, and numbers as they are.
bool numeric(const Value& value) {
    return value.isNumber() || value.get<bool>() != nullptr;
}
double asNumber(const Value& value) {
    const bool* truth = value.get<bool>();
    return truth != nullptr ? (*truth ? 1.0 : 0.0) : value.number();
}

bool isEqual(const Value& left, const Value& right) {
    if (numeric(left) && numeric(right)) {
        return asNumber(left) == asNumber(right);
    }
    if (left.data().index() != right.data().index()) {
        return false;
    }
    if (const List* list = left.get<List>()) {
        return areEqual(*list, *right.get<List>());
    }
    if (const Pose* pose = left.get<Pose>()) {
        return *pose == *right.get<Pose>();
    }
    const auto* text = left.get<std::string>();
    return text == nullptr || *text == *right.get<std::string>();
}

Result<Value> comparison(Op op, const Value& left, const Value& right) {
    if (op == Op::equal || op == Op::not_equal) {
        return Value(isEqual(left, right) == (op == Op::equal));
    }
    if (left.isNumber() && right.isNumber()) {
        return Value(compared(op, left.number(), right.number()));
    }
    const auto* left_text = left.get<std::string>();
    const auto* right_text = right.get<std::string>();
    if (left_text != nullptr && right_text != nullptr) {
        return Value(compared(op, *left_text, *right_text));
    }
    return mismatch(op, left, right);
}

bool isMatrix(const List& list) {
    return list.size() > 0 &&
           std::all_of(list.elements().begin(), list.elements().end(),
                       [](const Value& row) { return row.get<List>() != nullptr; });
}

/// Sum of the products of a row's elements and the values of `column` for each of them.
template <typename Column>
Result<Value> dotProduct(const List& row, std::size_t size, Column column) {
    if (row.size() != size) {
        return fail(Errc::invalid_argument,
                    fmt::format("a matrix with {} columns cannot be multiplied with {} rows",
                                row.size(), size));
    }
    Value sum(0);
    for (std::size_t i = 0; i < size; ++i) {
        const auto product = applyBinary(Op::multiply, row.elements()[i], column(i));
        METIER_ASSIGN(auto next, product ? applyBinary(Op::add, sum, *product) : product);
        sum = std::move(next);
    }
    return sum;
}

Result<Value> rowTimesMatrix(const List& row, const List& matrix) {
    const std::size_t columns = matrix.elements()[0].get<List>()->size();
    std::vector<Value> result;
    for (std::size_t j = 0; j < columns; ++j) {
        METIER_ASSIGN(auto element, dotProduct(row, matrix.size(), [&](std::size_t i) {
                          const List& matrix_row = *matrix.elements()[i].get<List>();
                          return j < matrix_row.size() ? matrix_row.elements()[j] : Value();
                      }));
        result.push_back(std::move(element));
    }
    return Value(List(std::move(result)));
}

Result<Value> matrixProduct(const List& left, const List& right) {
    constexpr std::size_t kMostProducts = 100'000;
    if (left.weight() * right.weight() > kMostProducts) {
        return fail(Errc::out_of_range, "the matrices are too large to be multiplied");
    }
    std::vector<Value> rows;
    for (const Value& row : left.elements()) {
        const List& elements = *row.get<List>();
        METIER_ASSIGN(auto product, isMatrix(right)
                                        ? rowTimesMatrix(elements, right)
                                        : dotProduct(elements, right.size(), [&](std::size_t i) {
                                              return right.elements()[i];
                                          }));
        rows.push_back(std::move(product));
    }
    return Value(List(std::move(rows)));
}

/// Whether a string that is added to every element of a list makes too many characters.
bool isTooLong(const Value& text, const List& list) {
    const auto* added = text.get<std::string>();
    return added != nullptr && added->size() * list.weight() > kMostCharacters;
}

/// Element by element; a scalar stands for every element.
Result<Value> ofLists(Op op, const Value& left, const Value& right) {
    const List* left_list = left.get<List>();
    const List* right_list = right.get<List>();
    const std::size_t size = (left_list != nullptr ? left_list : right_list)->size();
    if (left_list != nullptr && right_list != nullptr && left_list->size() != right_list->size()) {
        return fail(Errc::invalid_argument,
                    fmt::format("list of {} {} list of {}: the lengths differ", left_list->size(),
                                symbolOf(op), right_list->size()));
    }
    if (left_list == nullptr ? isTooLong(left, *right_list)
                             : right_list == nullptr && isTooLong(right, *left_list)) {
        return fail(Errc::out_of_range,
                    fmt::format("a list with more than {} characters", kMostCharacters));
    }
    std::vector<Value> result;
    result.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        METIER_ASSIGN(auto element,
                      applyBinary(op, left_list != nullptr ? left_list->elements()[i] : left,
                                  right_list != nullptr ? right_list->elements()[i] : right));
        result.push_back(std::move(element));
    }
    return Value(List(std::move(result)));
}

/// Poses are scaled, added and subtracted component by component; transformations have functions.
Result<Value> ofPoses(Op op, const Value& left, const Value& right) {
    const Pose* left_pose = left.get<Pose>();
    const Pose* right_pose = right.get<Pose>();
    const bool both = left_pose != nullptr && right_pose != nullptr;
    const bool scaled = !both && (left.isNumber() || right.isNumber());
    const bool possible = (both && (op == Op::add || op == Op::subtract)) ||
                          (scaled && (op == Op::multiply || op == Op::divide));
    if (!possible) {
        return mismatch(op, left, right);
    }
    Pose result;
    for (std::size_t i = 0; i < result.value.size(); ++i) {
        const double left_part = left_pose != nullptr ? left_pose->value[i] : left.number();
        const double right_part = right_pose != nullptr ? right_pose->value[i] : right.number();
        METIER_ASSIGN(const auto part, ofNumbers(op, left_part, right_part));
        result.value[i] = part.number();
    }
    return Value(result);
}

Result<Value> arithmetic(Op op, const Value& left, const Value& right) {
    const List* left_list = left.get<List>();
    const List* right_list = right.get<List>();
    if (left_list != nullptr || right_list != nullptr) {
        const bool product = op == Op::multiply && left_list != nullptr && right_list != nullptr &&
                             isMatrix(*left_list);
        return product ? matrixProduct(*left_list, *right_list) : ofLists(op, left, right);
    }
    if (left.get<Pose>() != nullptr || right.get<Pose>() != nullptr) {
        return ofPoses(op, left, right);
    }
    const auto* left_text = left.get<std::string>();
    const auto* right_text = right.get<std::string>();
    if (op == Op::add && left_text != nullptr && right_text != nullptr) {
        return Value(*left_text + *right_text);
    }
    return mismatch(op, left, right);
}

Result<Value> exclusiveOr(const Value& left, const Value& right) {
    const auto left_truth = truthOf(left);
    const auto right_truth = truthOf(right);
    if (!left_truth || !right_truth) {
        return mismatch(Op::logical_xor, left, right);
    }
    return Value(*left_truth != *right_truth);
}

}  // namespace

Result<Value> applyBinary(Op op, const Value& left, const Value& right) {
    if (isComparison(op)) {
        return comparison(op, left, right);
    }
    if (op == Op::logical_xor) {
        return exclusiveOr(left, right);
    }
    const auto* left_integer = left.get<std::int32_t>();
    const auto* right_integer = right.get<std::int32_t>();
    if (left_integer != nullptr && right_integer != nullptr) {
        return ofIntegers(op, *left_integer, *right_integer);
    }
    if (left.isNumber() && right.isNumber()) {
        return ofNumbers(op, left.number(), right.number());
    }
    return arithmetic(op, left, right);
}

Result<Value> negated(const Value& value) {
    if (value.get<Pose>() != nullptr || value.get<List>() != nullptr || value.isNumber()) {
        return applyBinary(Op::multiply, value, Value(-1));
    }
    return fail(Errc::type_mismatch, fmt::format("-{} is not possible", value.typeName()));
}

Result<bool> truthOf(const Value& value) {
    if (numeric(value)) {
        return asNumber(value) != 0.0;
    }
    if (const auto* text = value.get<std::string>()) {
        return !text->empty();
    }
    return fail(Errc::type_mismatch,
                fmt::format("a condition has to be a bool, not {}", value.typeName()));
}

}  // namespace metier::urscript
