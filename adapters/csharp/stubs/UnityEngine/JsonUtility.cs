using System;
using System.Globalization;
using System.Reflection;
using System.Text;
using System.Text.RegularExpressions;

namespace UnityEngine
{
    /// <summary>Supports objects with only float fields.</summary>
    public static class JsonUtility
    {
        public static string ToJson(object thing, bool pretty)
        {
            StringBuilder made = new StringBuilder("{");
            foreach (FieldInfo field in thing.GetType().GetFields())
            {
                string value = ((float)field.GetValue(thing)).ToString("R", CultureInfo.InvariantCulture);
                made.Append(made.Length > 1 ? "," : "").Append("\"" + field.Name + "\":" + value);
            }
            return made.Append("}").ToString();
        }

        public static T FromJson<T>(string text)
        {
            if (text.Length == 0)
            {
                return default(T);
            }
            if (!Regex.IsMatch(text, @"^\s*\{.*\}\s*$", RegexOptions.Singleline))
            {
                throw new ArgumentException("JSON parse error");
            }
            T made = (T)Activator.CreateInstance(typeof(T), true);
            foreach (FieldInfo field in typeof(T).GetFields())
            {
                Match match = Regex.Match(text, "\"" + field.Name + "\"\\s*:\\s*([-+.0-9eE]+)");
                if (match.Success)
                {
                    field.SetValue(made, float.Parse(match.Groups[1].Value, CultureInfo.InvariantCulture));
                }
            }
            return made;
        }
    }
}
