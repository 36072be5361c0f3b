// Python bindings of reports: the program's own report of a result.
#include "common/text.hpp"
#include "tools/program/arguments.hpp"
#include "tools/python/value.hpp"

namespace ukemi::python {

py::dict summary_of(const std::string& folder) {
  const py::object loads = py::module_::import("json").attr("loads");
  return loads(read_text_file(folder + "/" + kSummaryFile));
}

tools::CommonOptions report_options(const Path& folder, const std::vector<std::string>& formats, std::uint64_t seed) {
  if (folder.text.empty()) throw InputError("folder: '': a name is needed");
  tools::CommonOptions out{.folder = folder, .seed = seed};
  for (const std::string& f : formats)
    out.figures.push_back(tools::choice<std::string>("figures", f, {{"svg", "svg"}, {"pdf", "pdf"}, {"png", "png"}}));
  out.out = tools::CommonOptions::Stdout::kSilent;
  out.messages = tools::CommonOptions::Messages::kNone;
  return out;
}

void bind_report(py::module_& m) {
  std::string command = "python3";
  for (const py::handle word : py::module_::import("sys").attr("argv"))
    command += " " + shell_quoted(py::str(word).cast<std::string>());
  tools::set_command_line(command);
  m.def(
      "write_report",
      [](const py::object& result, const Path& folder, const std::vector<std::string>& figures) -> py::dict {
        if (!py::hasattr(result, "write_report"))
          throw InputError("result: " + py::str(py::type::of(result).attr("__name__")).cast<std::string>() +
                           ": what a verb returned is needed");
        return result.attr("write_report")(folder.text, figures);
      },
      py::arg("result"), py::arg("folder"), py::arg("figures") = std::vector<std::string>{},
      "Writes what the program's verb would for this result into a folder: report.html, summary.json and its other "
      "files; figures: formats of files of their own, of svg, pdf, png. Returns the summary.");
}

}  // namespace ukemi::python
