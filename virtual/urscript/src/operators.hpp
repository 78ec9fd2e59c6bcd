#pragma once

#include <array>
#include <span>
#include <string_view>

#include "code.hpp"
#include "metier/base/error.hpp"
#include "metier/urscript/value.hpp"

namespace metier::urscript {

// Operators on values. Errors: type_mismatch, out_of_range, invalid_argument; without position.
// Pure. Source: script manual, "Matrix and Array Expressions".

enum class Precedence : std::uint8_t { exclusive_or, comparison, sum, product };

/// An operator between two values; those of one precedence are applied from left to right.
struct BinaryOperator {
    Op op;
    TokenKind token;
    std::string_view symbol;
    Precedence precedence;
};

inline constexpr std::array kBinaryOperators{
    BinaryOperator{Op::logical_xor, TokenKind::word_xor, "xor", Precedence::exclusive_or},
    BinaryOperator{Op::equal, TokenKind::equal, "==", Precedence::comparison},
    BinaryOperator{Op::not_equal, TokenKind::not_equal, "!=", Precedence::comparison},
    BinaryOperator{Op::less, TokenKind::less, "<", Precedence::comparison},
    BinaryOperator{Op::less_equal, TokenKind::less_equal, "<=", Precedence::comparison},
    BinaryOperator{Op::greater, TokenKind::greater, ">", Precedence::comparison},
    BinaryOperator{Op::greater_equal, TokenKind::greater_equal, ">=", Precedence::comparison},
    BinaryOperator{Op::add, TokenKind::plus, "+", Precedence::sum},
    BinaryOperator{Op::subtract, TokenKind::minus, "-", Precedence::sum},
    BinaryOperator{Op::multiply, TokenKind::star, "*", Precedence::product},
    BinaryOperator{Op::divide, TokenKind::slash, "/", Precedence::product},
    BinaryOperator{Op::remainder, TokenKind::percent, "%", Precedence::product},
};

/// \param op one of kBinaryOperators
Result<Value> applyBinary(Op op, const Value& left, const Value& right);
Result<Value> negated(const Value& value);
/// Truth of a value: a bool itself; numbers are true if not 0, strings if not empty.
Result<bool> truthOf(const Value& value);

Result<Value> elementOf(const Value& value, std::span<const Value> indices);
Result<void> setElement(Value& target, std::span<const Value> indices, Value value);

/// A list, if it is not nested too deeply. Errors: out_of_range.
Result<Value> listOf(std::vector<Value> elements);
/// A pose of 6 numbers.
Result<Value> poseOf(std::span<const Value> elements);

/// Cost of copying or making a value, in instructions; 0 for small ones.
std::size_t costOf(const Value& value);

}  // namespace metier::urscript
