#include "output/write_polydata.h"

#include "patchlight/base/error.h"
#include "patchlight/output/whole_file.h"

#include <string>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

namespace patchlight {
namespace {

// The first error that VTK reports, kept instead of printed.
void keep_first_error(vtkObject*, unsigned long, void* message, void* text) {
  auto& kept = *static_cast<std::string*>(message);
  if (kept.empty() && text != nullptr) kept = static_cast<const char*>(text);
}

}  // namespace

void write_polydata(const std::filesystem::path& file, vtkPolyData& polygons) {
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    std::string error;
    const vtkNew<vtkCallbackCommand> on_error;
    on_error->SetCallback(keep_first_error);
    on_error->SetClientData(&error);
    const vtkNew<vtkXMLPolyDataWriter> writer;
    writer->AddObserver(vtkCommand::ErrorEvent, on_error);
    writer->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, on_error);
    writer->SetInputData(&polygons);
    writer->SetFileName(temporary.c_str());
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToLZ4();
    writer->SetHeaderTypeToUInt64();
    const bool written = writer->Write() != 0 && writer->GetErrorCode() == vtkErrorCode::NoError && error.empty();
    if (!written) throw OutputError(file.string(), "cannot be written; is the disk full?");
  });
}

}  // namespace patchlight
