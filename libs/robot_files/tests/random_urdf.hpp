#pragma once

#include <fmt/format.h>

#include <iterator>
#include <random>
#include <string>

namespace metier::robot_files {

/// Number of joints of a random chain; negative: random, too.
struct RandomChain {
    int axes = -1;   ///< 1 to 7
    int fixed = -1;  ///< fixed joints at a random place each, 0 to 4
};

/// Writes a URDF file of one chain with random origins, axes and fixed joints. Some angles are
/// right ones, some are close to gimbal lock.
class RandomUrdf {
public:
    RandomUrdf(std::mt19937_64& random, const RandomChain& chain) : random_(random) {
        int axes = chain.axes < 0 ? whole(1, 7) : chain.axes;
        int fixed = chain.fixed < 0 ? whole(0, 4) : chain.fixed;
        add("<robot name=\"random\">\n<link name=\"l0\"/>\n");
        for (int n = 1; axes + fixed > 0; ++n) {
            const bool turns = whole(1, axes + fixed) <= axes;
            (turns ? axes : fixed) -= 1;
            addJoint(n, turns);
        }
        add("</robot>\n");
    }
    const std::string& text() const { return text_; }

private:
    template <typename... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }
    int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
    double real(double most) {
        return std::uniform_real_distribution<double>(-most, most)(random_);
    }

    double angle() {
        switch (whole(0, 4)) {
            case 0:
                return 0;
            case 1:
                return 1.5707963267948966;
            case 2:
                return -1.5708;
            case 3:
                return 1.57079632679 - whole(0, 1) * 3e-8;
            default:
                return real(7);
        }
    }

    void addJoint(int n, bool turns) {
        add("<link name=\"l{}\"/>\n<joint name=\"j{}\" type=\"{}\">", n, n,
            turns ? "revolute" : "fixed");
        add("<origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/>", real(0.5), real(0.5), real(0.5), angle(),
            angle(), angle());
        add("<parent link=\"l{}\"/><child link=\"l{}\"/>", n - 1, n);
        add("<axis xyz=\"{} {} {}\"/>", real(1), whole(-1, 1), real(2));
        add("<limit lower=\"-2\" upper=\"3\" velocity=\"1\" effort=\"1\"/></joint>\n");
    }

    std::mt19937_64& random_;
    std::string text_;
};

inline std::string randomUrdf(std::mt19937_64& random, const RandomChain& chain = {}) {
    return RandomUrdf(random, chain).text();
}

}  // namespace metier::robot_files
