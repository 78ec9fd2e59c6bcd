#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace metier::fuzz {

/// Takes bytes off the front of an input; 0 when there are none left.
class Input {
public:
    Input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
    bool isEmpty() const { return left_ == 0; }
    std::uint8_t next() {
        if (left_ == 0) {
            return 0;
        }
        --left_;
        return *data_++;
    }
    /// Text up to the next line feed, or the end.
    std::string line() {
        std::string text;
        while (!isEmpty()) {
            const char character = static_cast<char>(next());
            if (character == '\n') {
                break;
            }
            text += character;
        }
        return text;
    }
    /// Number between -bound and bound.
    double number(double bound) { return (next() / 127.5 - 1.0) * bound; }

private:
    const std::uint8_t* data_;
    std::size_t left_;
};

}  // namespace metier::fuzz
