#pragma once

#include <string>
#include <vector>

namespace metier::app {

/// Lines on the terminal that show how several things go on. On a terminal each line is redrawn in
/// place; elsewhere a line is printed whenever it is final.
///
/// Threading: one thread.
class ProgressView {
public:
    enum class Output { terminal, plain };
    /// terminal if standard error is one and the user did not set NO_COLOR or TERM=dumb.
    static Output detect();

    /// Writes to standard error, since standard output belongs to results.
    ProgressView(std::vector<std::string> names, Output output);

    /// \param fraction done, 0 to 1
    void update(std::size_t row, double fraction, const std::string& text);
    /// Marks a row as ended, with its last word.
    void finish(std::size_t row, const std::string& text);

private:
    struct Row {
        std::string name;
        std::string text;
        double fraction = 0;
    };
    void redraw();

    std::vector<Row> rows_;
    Output output_;
    bool drawn_ = false;
};

}  // namespace metier::app
