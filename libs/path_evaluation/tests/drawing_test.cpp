#include "metier/path_evaluation/drawing.hpp"

#include <gmock/gmock.h>

#include <pugixml.hpp>
#include <sstream>

namespace metier::path_evaluation {
namespace {

using ::testing::HasSubstr;

DrawnPath onePath(std::string name) {
    DrawnPath path;
    path.name = std::move(name);
    for (std::size_t i = 0; i <= kCorners; ++i) {
        path.positions.push_back(path.square.corner(i).translation);
    }
    path.measurement = {0.0000123, 0.0000045};
    return path;
}

pugi::xml_document parsed(const std::string& svg) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(svg.c_str()));
    return document;
}

TEST(DrawSvg, HasOnePanelForEachPath) {
    const std::vector<DrawnPath> paths{onePath("UR5"), onePath("e.DO")};
    const auto document = parsed(drawSvg(paths));
    EXPECT_EQ(document.select_nodes("//*[@class='title']").size(), 2U);
    EXPECT_EQ(document.select_nodes("//*[@class='measured']").size(), 2U);
    EXPECT_EQ(document.select_nodes("//*[@class='deviation']").size(), 2U);
}

TEST(DrawSvg, DrawsThePathOntoItsSquare) {
    const std::vector<DrawnPath> paths{onePath("UR5")};
    const auto document = parsed(drawSvg(paths));
    const std::string ideal =
        document.select_node("//*[@class='ideal']").node().attribute("points").value();
    const std::string measured =
        document.select_node("//*[@class='measured']").node().attribute("points").value();
    EXPECT_THAT(measured, ::testing::StartsWith(ideal));
}

TEST(DrawSvg, WritesFiguresInMillimetres) {
    const std::vector<DrawnPath> paths{onePath("UR5")};
    EXPECT_THAT(drawSvg(paths), HasSubstr("deviation 0.0123 mm, closure 0.0045 mm"));
}

TEST(DrawSvg, EscapesNamesAndSurvivesEmptyPaths) {
    const std::vector<DrawnPath> paths{{"<a & \"b\">", Square{}, {}, {}}};
    const auto document = parsed(drawSvg(paths));
    EXPECT_STREQ(document.select_node("//*[@class='title']").node().text().get(), "<a & \"b\">");
}

/// Numbers of the attribute `points` of the one element of that class.
std::vector<double> pointsOf(const pugi::xml_document& document, const std::string& style) {
    const auto found = document.select_nodes(("//*[@class='" + style + "']").c_str());
    EXPECT_EQ(found.size(), 1U) << style;
    std::istringstream text(found.first().node().attribute("points").value());
    std::vector<double> numbers;
    double number = 0;
    char comma = ',';
    while (text >> number) {
        numbers.push_back(number);
        text >> comma >> number;
        numbers.push_back(number);
    }
    return numbers;
}

TEST(DrawSvg, DrawsEachPanelAtTheSamePlaceOfItsOwn) {
    const auto first = parsed(drawSvg(std::vector{onePath("UR5")}));
    std::vector<DrawnPath> paths{{"empty", Square{}, {}, {}}, onePath("UR5")};
    const auto second = parsed(drawSvg(paths));
    const auto alone = pointsOf(first, "deviation");
    const auto points = second.select_nodes("//*[@class='measured']");
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(second.child("svg").attribute("width").as_double(),
              2 * first.child("svg").attribute("width").as_double());
    ASSERT_EQ(alone.size(), 10U);
    for (std::size_t i = 2; i < alone.size(); i += 2) {
        EXPECT_NEAR(alone[i] - alone[i - 2], alone[2] - alone[0], 0.02) << "evenly along the way";
    }
}

TEST(DrawSvg, ADeviationBeyondTheScaleStaysInItsFrame) {
    auto path = onePath("UR5");
    path.positions.push_back({9.0, 9.0, 9.0});
    path.measurement.largest_deviation = 0.001;  // of another measurement
    const auto document = parsed(drawSvg(std::vector{path}));
    const auto frames = document.select_nodes("//rect[@class='frame']");
    ASSERT_EQ(frames.size(), 2U);
    const double top = frames[1].node().attribute("y").as_double();
    const double bottom = top + frames[1].node().attribute("height").as_double();
    const auto points = pointsOf(document, "deviation");
    for (std::size_t i = 1; i < points.size(); i += 2) {
        EXPECT_GE(points[i], top);
        EXPECT_LE(points[i], bottom);
    }
    EXPECT_NEAR(points.back(), top, 0.01);
}

TEST(DrawSvg, TheScaleOfDeviationsIsRoundAndNamed) {
    auto path = onePath("UR5");
    path.measurement.largest_deviation = 0.00031;
    EXPECT_THAT(drawSvg(std::vector{path}), HasSubstr(">0.5 mm<"));
    path.measurement.largest_deviation = 0;
    EXPECT_THAT(drawSvg(std::vector{path}), HasSubstr(">1e-06 mm<"));
    EXPECT_THAT(drawSvg(std::vector{path}), HasSubstr(">100 mm<"));  // the side
}

TEST(DrawSvg, DrawsAPictureWithoutPaths) {
    const auto document = parsed(drawSvg({}));
    EXPECT_GT(document.child("svg").attribute("width").as_double(), 0);
}

}  // namespace
}  // namespace metier::path_evaluation
