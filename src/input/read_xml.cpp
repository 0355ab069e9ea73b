#include "input/read_xml.h"

#include "patchlight/base/error.h"

#include "input/read_gbxml.h"
#include "input/read_mitsuba.h"
#include "input/xml_file.h"

#include <string_view>

namespace patchlight {

Scene read_xml(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  const XmlFile xml = read_xml_file(file, file.string());
  const std::string root = xml.document.document_element().name();
  if (root == "scene") return read_mitsuba(file, metres_per_unit, confine);
  if (root == "gbXML") return read_gbxml(xml, metres_per_unit);
  throw InputError(file.string(), "the first element is <" + root +
                                      ">; expected <scene>, of a Mitsuba scene, or <gbXML>, of a building");
}

}  // namespace patchlight
