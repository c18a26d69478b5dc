using System.Collections.Generic;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Lists plug-ins for a drop-down.</summary>
    internal static class PluginDropDown
    {
        /// <summary>
        /// Returns the names, after an entry for the server's default. chosen: is listed even if the server lacks it.
        /// </summary>
        public static string[] Of(Wire.Items<Wire.Plugin> plugins, string chosen)
        {
            List<string> names = new List<string> { "(the server's)" };
            for (int i = 0; i < plugins.Count; i++)
            {
                names.Add(plugins[i].Name);
            }
            if (chosen.Length > 0 && !names.Contains(chosen))
            {
                names.Add(chosen);
            }
            return names.ToArray();
        }

        /// <summary>Returns the index of the chosen name; 0 for "".</summary>
        public static int Index(string[] names, string chosen)
        {
            int index = chosen.Length == 0 ? 0 : System.Array.IndexOf(names, chosen);
            return index < 0 ? 0 : index;
        }
    }
}
