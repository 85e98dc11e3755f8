// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiPVContinuousHistogram
 * @brief   vtkChiContinuousHistogram with moments, median and masses as field data of the table
 *
 * Of several processes the first one alone has the table: ParaView appends those of all.
 */
#ifndef vtkChiPVContinuousHistogram_h
#define vtkChiPVContinuousHistogram_h

#include "vtkChiContinuousHistogram.h"
#include "vtkChiParaViewFiltersModule.h" // for export macro

class VTKCHIPARAVIEWFILTERS_EXPORT vtkChiPVContinuousHistogram : public vtkChiContinuousHistogram
{
public:
  static vtkChiPVContinuousHistogram* New();
  vtkTypeMacro(vtkChiPVContinuousHistogram, vtkChiContinuousHistogram);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * SetInputArrayToProcess, unless the name is empty.
   */
  void SelectArray(int index, int port, int connection, int association, const char* name);

protected:
  vtkChiPVContinuousHistogram() = default;
  ~vtkChiPVContinuousHistogram() override = default;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiPVContinuousHistogram(const vtkChiPVContinuousHistogram&) = delete;
  void operator=(const vtkChiPVContinuousHistogram&) = delete;
};

#endif
