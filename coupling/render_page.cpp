#include "coupling/render_page.hpp"

#include <fmt/format.h>

namespace coupling {
namespace {

std::string escaped(const std::string& text) {
  std::string safe;
  for (char letter : text) {
    if (letter == '&')
      safe += "&amp;";
    else if (letter == '<')
      safe += "&lt;";
    else if (letter == '>')
      safe += "&gt;";
    else if (letter == '"')
      safe += "&quot;";
    else
      safe += letter;
  }
  return safe;
}

constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 1200px; margin: 2em auto; padding: 0 1em; }}
img {{ width: 100%; border: 1px solid #ddd; }}
table {{ border-collapse: collapse; width: 100%; }}
th, td {{ text-align: left; padding: 0.3em 0.8em; border-bottom: 1px solid #ddd; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
figure {{ margin: 2em 0; }}
figcaption {{ color: #555; }}
</style>
</head>
<body>
<h1>{0}</h1>
)";

std::string caption(const std::string& stem) {
  if (stem == "view") return "The whole model.";
  if (stem == "cut_stress")
    return "Section in the middle of the bay: vertical stress in the solids (tension positive), force chains between "
           "the "
           "grains near the section.";
  if (stem == "cut_displacement") return "The same section: vertical displacement of solids and grains (up positive).";
  if (stem == "curves") return "Probes and energy over time.";
  return spaced(stem);
}

}  // namespace

std::string results_page(const RunDirectory& run, const std::vector<std::filesystem::path>& pictures) {
  std::string page = fmt::format(fmt::runtime(head), escaped(run.title));
  if (!run.remarks.empty()) {
    page += "<p>";
    for (std::size_t i = 0; i < run.remarks.size(); ++i) page += (i > 0 ? " · " : "") + escaped(run.remarks[i]);
    page += "</p>\n";
  }
  if (!run.results.empty()) {
    page +=
        "<table>\n<tr><th>result</th><th>value</th><th>unit</th><th>expected</th><th>off by</th><th>source</th></tr>\n";
    for (const auto& line : run.results)
      page += fmt::format(
          "<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td><td>{}</td><td "
          "class=\"number\">{}</td><td>{}</td></tr>\n",
          escaped(spaced(line.name)), escaped(line.value), escaped(line.unit), escaped(line.expected),
          escaped(line.relative_error), escaped(line.source));
    page += "</table>\n";
  }
  for (const auto& picture : pictures) {
    const std::string name = picture.filename().string(), stem = picture.stem().string();
    page +=
        fmt::format("<figure><a href=\"{0}\"><img src=\"{0}\" alt=\"{1}\"></a><figcaption>{1}</figcaption></figure>\n",
                    escaped(name), escaped(caption(stem)));
  }
  return page + "</body>\n</html>\n";
}

}  // namespace coupling
