// Tables as text, files of a subject, lists of settings.
#include "engine/laboratory/bench/charts/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/staged_folder.h"
#include "engine/io/image/image_file.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string cell_text(const Json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_number()) return number_text(value.get<double>());
    return value.is_string() ? value.get<std::string>() : std::string("-");
}

std::string table_text(const Table& table) {
    std::vector<std::size_t> widths(table.head.size(), 0);
    const auto widen = [&](const std::vector<std::string>& row) {
        for (std::size_t c = 0; c < std::min(row.size(), widths.size()); ++c)
            widths[c] = std::max(widths[c], row[c].size());
    };
    widen(table.head);
    for (const auto& row : table.rows) widen(row);
    const auto line = [&](const std::vector<std::string>& row) {
        std::string text;
        for (std::size_t c = 0; c < std::min(row.size(), widths.size()); ++c)
            text += c == 0 ? fmt::format("{:<{}}", row[c], widths[c])
                           : fmt::format("  {:>{}}", row[c], widths[c]);
        return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
    };
    std::string text = table.title.empty() ? "" : table.title + "\n";
    text += line(table.head);
    for (const auto& row : table.rows) text += line(row);
    return text;
}

}  // namespace

Table points_table(const std::string& title, const Json& points, const std::vector<Column>& columns) {
    Table table{title, {"setting"}, {}};
    for (const auto& column : columns) table.head.push_back(column.title);
    table.head.emplace_back("");
    for (const auto& point : points) {
        const auto curve = point.value("curve", ""), name = point.value("name", "");
        std::vector<std::string> row{curve.empty() ? name : curve + ", " + name};
        for (const auto& column : columns)
            row.push_back(point.contains(column.key) ? cell_text(point[column.key]) : "-");
        row.emplace_back(point.value("default", false) ? "default" : "");
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::vector<std::string> front_remarks(const Json& fronts, const std::vector<std::string>& titles) {
    std::vector<std::string> remarks;
    for (std::size_t i = 0; i < fronts.size() && i < titles.size(); ++i) {
        const auto& standard = fronts[i]["default"];
        if (!standard.is_object()) continue;
        std::string others;
        for (const auto& name : standard["beaten_by"])
            others += (others.empty() ? "" : "; ") + name.get<std::string>();
        std::string within;
        for (const auto& lead : standard["within_scatter"])
            within += fmt::format("{}{} (by {:.2g}, standard error {:.2g})", within.empty() ? "" : "; ",
                                  lead["name"].get<std::string>(), lead["lead"].get<double>(),
                                  lead["standard_error"].get<double>());
        if (standard["on_front"].get<bool>() && within.empty())
            remarks.push_back(fmt::format("{}: the default lies on the front.", titles[i]));
        else if (standard["on_front"].get<bool>())
            remarks.push_back(fmt::format(
                "{}: the default lies on the front within the scatter of the cases; ahead by less "
                "than twice the standard error: {}.",
                titles[i], within));
        else if (others.empty())
            remarks.push_back(fmt::format("{}: the default could not be measured.", titles[i]));
        else
            remarks.push_back(fmt::format("{}: the default does not lie on the front; it is beaten by: {}.",
                                          titles[i], others));
    }
    return remarks;
}

std::string subject_text(const Subject& subject) {
    std::string text;
    for (const auto& table : subject.tables) text += table_text(table) + "\n";
    for (const auto& remark : subject.remarks) text += remark + "\n";
    return text;
}

void leave_subject(const Subject& subject, const std::filesystem::path& folder) {
    const auto json = subject.name + ".json", png = subject.name + ".png";
    StagedFolder staged(folder, {json, {json, png}});
    write_png(staged.path() / png, subject.picture);
    Json report = subject.report;
    report["files"] = staged.listing();
    write_file(staged.path() / json, json_text(report, 1) + "\n");
    staged.commit();
}

std::vector<std::string> words_in_list(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t at = 0; at < text.size();) {
        const auto first = text.find_first_not_of(" ,", at);
        if (first == std::string::npos) break;
        const auto end = std::min(text.find_first_of(" ,", first), text.size());
        words.push_back(text.substr(first, end - first));
        at = end;
    }
    return words;
}

std::vector<double> numbers_in_list(const std::string& name, const std::string& text, double low,
                                    double high) {
    std::vector<double> numbers;
    for (const auto& word : words_in_list(text)) {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        if (*end != 0 || !(value >= low && value <= high))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("{}: \"{}\" is not a number from {:g} to {:g}", name, word, low, high),
                        "write numbers with spaces between them");
        numbers.push_back(value);
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
}

void parse_picture_size(const std::string& text, int& width, int& height) {
    constexpr int most = 16384;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 1 || height < 1 ||
        width > most || height > most)
        throw Error(ErrorCode::InvalidArgument, "the size \"" + text + "\" is not understood",
                    "write it like 1280x720");
}

}  // namespace gse::bench
